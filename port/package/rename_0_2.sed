# rename_0_2.sed: rewrites a caller of smr 0.2 for 1.0: sed -E -i -f rename_0_2.sed FILE.c   GNU sed; twice does no harm.
# Fields are found by their variables' names: ...config..., ...cfg..., ...settings...; ...report..., ...last... or r;
# ...verdict..., ...measures... or v. The compiler names the rest. New struct names need nothing.
# SPDX-License-Identifier: MIT
s/\bsmr_get_seen\b/smr_get_visible/g
s/\bSMR_REASON_NOTHING_SEEN\b/SMR_REASON_NOTHING_VISIBLE/g
s/\bSMR_REASON_UNSEEN\b/SMR_REASON_LITTLE_VISIBLE/g
s/\bSMR_REASON_LIKENESS\b/SMR_REASON_SIMILARITY/g
s/\bSMR_(TRACK|DYNAMICS|LANDMARKS|CALLER|VOLUME|SMOOTH|CONTACT)_BYTES\b/SMR_ARENA_\1_BYTES/g
# smr_config
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(n_workers|n_target_vertices|method|iterations|iterations_last|active_share|search_mm|attraction|slide|even)\b/\1\4basic.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(profile_mm|profile_end_mm|gradient_mm|gradient_end_mm|similarity|confidence|profile_radii|sideways|fill)\b/\1\4image.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(nearer|edge|blend|fade)\b/\1\4image.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)image_beside\b/\1\4image.beside/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(coverage|noise_mm|n_landmarks)\b/\1\4partial.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track\b([^.(]|$)/\1\4track.mode\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track_mm\b/\1\4track.radius_mm/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track_jump_mm\b/\1\4track.jump_mm/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track_um\b/\1\4track.settle_um/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track_iterations\b/\1\4track.iterations/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)track_ahead\b/\1\4track.ahead/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)contact\b([^.(]|$)/\1\4contact.share\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)contact_mm\b/\1\4contact.gap_mm/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(n_fixed|volume|smooth)\b/\1\4contact.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)dynamics\b([^.(]|$)/\1\4dynamics.mode\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(step_ms|damping|gravity|elastic)\b/\1\4dynamics.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)caller_goals\b/\1\4caller.goals/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)caller_force\b/\1\4caller.force/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(stiffness|search_radii|normal_deg|reject_deviations|reject_border|node_budget|use_box|box_min|box_max)\b/\1\4forces.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(relaxation|momentum|momentum_last|plastic_um|plastic_every|plastic_by|settle_um|fold_guard|normals|turn_deg)\b/\1\4motion.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(fusing)\b/\1\4motion.\5/g
s/\b([A-Za-z_0-9]*(config|cfg|settings)[A-Za-z_0-9]*(\[[^]]*\])?)(\.|->)(radius_first|radius_last|active_first|active_enough)\b/\1\4schedule.\5/g
# smr_tick_report
s/\b(([A-Za-z_0-9]*(report|last)[A-Za-z_0-9]*|r)(\[[^]]*\])?)(\.|->)(phase|radius|radius_iteration|n_taken|n_wanted|n_active|n_rejected|matched_share|n_guarded|attraction_used)\b/\1\5details.\6/g
s/\b(([A-Za-z_0-9]*(report|last)[A-Za-z_0-9]*|r)(\[[^]]*\])?)(\.|->)(residual_rms_mm|residual_max_mm|phase_ns|plastic_updates|tracking|settled|jumped)\b/\1\5details.\6/g
# smr_verdict
s/\b(([A-Za-z_0-9]*(verdict|measures)[A-Za-z_0-9]*|v)(\.|->))seen_share\b/\1visible_share/g
s/\b(([A-Za-z_0-9]*(verdict|measures)[A-Za-z_0-9]*|v)(\.|->))likeness\b/\1image_similarity/g
