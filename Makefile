# smr: build rules. GNU make only; `make help` lists the targets.
# SPDX-License-Identifier: MIT

# ---------------------------------------------------------------- variables that the caller may set

# WITHOUT leaves capabilities out of the library: make WITHOUT="image track". The rest of the tree needs all of them,
# so this builds the library, the program, which then refuses to run, and the golden run.
CAPABILITIES := image partial track contact dynamics references
WITHOUT ?=
ifneq ($(filter-out $(CAPABILITIES),$(WITHOUT)),)
$(error WITHOUT takes words of: $(CAPABILITIES))
endif
without := $(subst image,IMAGE,$(subst partial,PARTIAL,$(subst track,TRACK,$(subst contact,CONTACT,\
           $(subst dynamics,DYNAMICS,$(subst references,REFERENCES,$(WITHOUT)))))))

# BUILD names the build directory, so several compilers can build side by side:
#   make BUILD=build/clang CC=clang
BUILD   ?= build$(subst $() ,,$(WITHOUT:%=/without-%))
PREFIX  ?= /usr/local
LIBDIR  ?= $(PREFIX)/lib
DESTDIR ?=
NM      ?= nm
SIZE    ?= size
V       ?= 0

ifneq ($(words $(BUILD)),1)
$(error BUILD is "$(BUILD)": make takes one word, without spaces)
endif

# Prints one short line per file. V=1 prints whole commands instead, `make -s` prints nothing.
begin = @mkdir -p $(@D) && printf '%-4s %s\n' $(1) '$(2)'
Q     := @
ifeq ($(V),1)
begin = @mkdir -p $(@D)
Q     :=
else ifneq ($(findstring s,$(firstword -$(MAKEFLAGS))),)
begin = @mkdir -p $(@D)
endif

# The flags that the promise of equal bits rests on come first; the user's CFLAGS come last.
STD      := -std=c11 -ffp-contract=off -fno-math-errno
WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Wcast-qual -Wcast-align -Wstrict-prototypes -Wvla \
            -Wdouble-promotion
ifneq ($(or $(filter true,$(CI)),$(filter 1,$(WERROR))),)
WARNINGS += -Werror
endif
override ALL_CFLAGS := $(STD) -O3 $(WARNINGS) -MMD -MP $(CFLAGS)
THREADS  := -pthread

# The emulated boards. The M55's vector unit would flush denormals: nomve.fp keeps it to integers. tests/target, `make size` and
# `make stack` share what is compiled for the M7 with -O2.
M7_CFLAGS := -mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -ffunction-sections -fdata-sections -fstack-usage
M7_BOARD  := $(BUILD)/m7-board
M55_CFLAGS := -mthumb -mcpu=cortex-m55+nomve.fp -mfloat-abi=hard -ffunction-sections -fdata-sections
export M7_CFLAGS M55_CFLAGS

# ---------------------------------------------------------------- sources

CORE_SRC    := $(sort $(wildcard src/*.c src/*/*.c src/*/*/*.c))
ifeq ($(CORE_SRC),)
$(error no sources below $(CURDIR)/src: call make in the folder of this Makefile, or as make -C FOLDER)
endif
PTHREAD_SRC := $(sort $(wildcard port/pthread/*.c))
HOST_SRC    := $(sort $(wildcard port/host/*/*.c))
HOST_MAIN   := $(wildcard port/host/main.c)
FIXTURE_SRC := $(filter-out fixtures/fixture_write.c,$(sort $(wildcard fixtures/*.c)))
BAREMETAL_SRC := $(sort $(wildcard port/baremetal/*.c))
TARGET_SRC  := $(sort $(wildcard tests/target/target_*.c))

TEST_SRC    := $(sort $(wildcard tests/unit/test_*.c tests/property/test_*.c tests/golden/test_*.c))
HOST_TEST_SRC := $(sort $(wildcard tests/host/test_*.c))
CASE_SRC    := $(sort $(wildcard tests/experiments/*.c))
BENCH_SRC   := $(sort $(wildcard tests/bench/bench_*.c))
# Every other file beside the tests is a helper: those of tests/host are the host's tests' own, all tests may call the
# others. tests/host/*_tool.c are programs that the scripts there call; two of them are compiled by theirs in another way.
HOST_HELPER_SRC := $(filter-out $(HOST_TEST_SRC) %_tool.c,$(sort $(wildcard tests/host/*.c)))
HELPER_SRC  := $(filter-out $(TEST_SRC) $(BENCH_SRC), \
               $(sort $(wildcard tests/*.c tests/unit/*.c tests/property/*.c tests/bench/*.c)))

# ---------------------------------------------------------------- what is built from them

obj = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))
CORE_OBJ    := $(call obj,$(CORE_SRC))
PTHREAD_OBJ := $(call obj,$(PTHREAD_SRC))
HOST_OBJ    := $(call obj,$(HOST_SRC))
HOST_MAIN_OBJ := $(call obj,$(HOST_MAIN))
PAGE_PARTS  := $(wildcard port/host/html/*.html port/host/html/*.css port/host/html/*.js) port/host/html/embed_page.sh
PAGE_OBJ    := $(BUILD)/obj/page/report_page.o
FIXTURE_OBJ := $(call obj,$(FIXTURE_SRC))
SUPPORT_OBJ := $(call obj,$(FIXTURE_SRC) $(HELPER_SRC))
PRINT_OBJ   := $(call obj,tests/golden/print.c)
FAULTS_SRC  := $(sort $(wildcard tests/faults/*.c))
GOLDEN_OBJ  := $(call obj,$(addprefix tests/golden/golden,.c _goals.c _images.c _save.c)) $(PRINT_OBJ)
ANSWERS_OBJ := $(call obj,$(addprefix tests/golden/answers,.c _run.c _calls.c))

CORE_LIB    := $(BUILD)/libsmr.a
PTHREAD_LIB := $(BUILD)/libsmr_pthread.a
HOST_LIB    := $(BUILD)/libhost.a
SUPPORT_LIB := $(BUILD)/libsupport.a
PROGRAM     := $(if $(HOST_MAIN),$(BUILD)/smr)
SHARED_OBJ  := $(patsubst %.c,$(BUILD)/pic/%.o,$(CORE_SRC) $(PTHREAD_SRC))
TESTS       := $(patsubst tests/%.c,$(BUILD)/tests/%,$(TEST_SRC))
HOST_TESTS  := $(patsubst tests/%.c,$(BUILD)/tests/%,$(HOST_TEST_SRC))
HOST_TOOL_SRC := $(addprefix tests/host/,mesh_tool.c volume_tool.c log_tool.c fuzz_tool.c)
HOST_TOOLS  := $(patsubst tests/%.c,$(BUILD)/tests/%,$(HOST_TOOL_SRC))
EXPERIMENTS := tests/experiments/experiments.sh
CASE_TOOL   := $(BUILD)/case_tool
BENCHES     := $(patsubst tests/%.c,$(BUILD)/tests/%,$(BENCH_SRC))
ALL_OBJ     := $(CORE_OBJ) $(PTHREAD_OBJ) $(HOST_OBJ) $(HOST_MAIN_OBJ) $(SUPPORT_OBJ) $(GOLDEN_OBJ) $(ANSWERS_OBJ) \
               $(call obj,$(TEST_SRC) $(HOST_TEST_SRC) $(HOST_HELPER_SRC) $(CASE_SRC) $(BENCH_SRC) \
               $(BAREMETAL_SRC) $(TARGET_SRC) $(FAULTS_SRC) fixtures/fixture_write.c \
               tests/golden/replay_run.c tests/docs/settings_page.c $(HOST_TOOL_SRC) $(wildcard port/template/*.c)) \
               $(SHARED_OBJ) $(PAGE_OBJ)

# ---------------------------------------------------------------- the first target, and the list of all

.PHONY: all help demo demo-bone check check-quick experiments programs layer-objects cmocka bench figure1 figure2 soak size \
        faults stack hashes settings-page golden-update boards timing timing-calls timing-ticks timing-update shared amalgamation install install-core \
        install-shared clean
.DELETE_ON_ERROR:

all: $(CORE_LIB) $(PTHREAD_LIB) $(PROGRAM) $(if $(WITHOUT),$(BUILD)/golden)

help:
	@echo 'make                 libsmr.a, libsmr_pthread.a and the program smr in $(BUILD)/'
	@echo 'make demo            a computed thigh of 24 structures onto a patient'"'"'s MRI, and how well'
	@echo 'make demo-bone       a generated bone onto a deformed one'
	@echo 'make check           all tests; the last line is the sum; logs in $(BUILD)/log'
	@echo 'make check-quick     unit tests, golden run and the checks of the sources; less than a minute'
	@echo 'make check-html      the page of a report in a headless Chromium; skipped without one'
	@echo 'make experiments     accuracy on real data, as tables; minutes; skipped without ../shared'
	@echo 'make results         measures and writes docs/RESULTS.md and README'"'"'s table; many minutes'
	@echo 'make results-short   the same without what takes minutes: at most 8'
	@echo 'make bench           benchmarks; writes $(BUILD)/bench.json'
	@echo 'make figure1         the paper'"'"'s figure 1, distance over time for four radii, into docs/figures'
	@echo 'make figure2         the paper'"'"'s figure 2, time and error over ignored vertices, into docs/figures'
	@echo 'make soak            how far ticks overrun budgets of 1 to 33 ms on this machine; asserts nothing'
	@echo 'make size            bytes of the library, and of the smallest program with each capability left out'
	@echo 'make stack           largest stack frames; fails on an unbounded one'
	@echo 'make coverage        lines, branches and MC/DC of src that the tests run, by folder; 15 minutes'
	@echo 'make mutants         plants N=200 faults, drawn by SEED=1, and counts those that the tests find; an hour'
	@echo 'make faults          flips N=100000 bits between ticks, drawn by SEED=1, and counts what follows; 10 minutes'
	@echo 'make peers           other programs beside smr, elastix too, into docs/RESULTS.md; 6 minutes'
	@echo 'make fuzz            fuzzes each target SECONDS=60 under sanitisers, from the kept corpora (clang)'
	@echo 'make hashes          state hash over threads, schedulers, compilers and processors'
	@echo 'make settings-page   writes $(BUILD)/SETTINGS.md from the tables of settings'
	@echo 'make man             man pages and shell completion, from the table of options, in $(BUILD)/man'
	@echo 'make reference       the interface as one page, from include/smr.h: $(BUILD)/reference.html'
	@echo 'make golden-update   records the current state hash and answers as the expected ones'
	@echo 'make api-update      records functions, layouts and values of the public headers as the expected ones'
	@echo 'make kept-update     writes the model, log and save of this version that later versions read, tests/golden/kept'
	@echo 'make check-itk       fields, surfaces and label maps read by ITK, where CMake and ITK are installed'
	@echo 'make boards          golden bits, flash, RAM, stack and instructions on eight emulated boards; minutes'
	@echo 'make timing          10,000 ticks of random budgets on each emulated board, and the table of'
	@echo '                     instructions; minutes'
	@echo 'make timing-ticks    N (10^6) ticks of 0.05 to 2 ms of a bone of 3,600 vertices on the Cortex-M7'
	@echo 'make timing-calls    instructions of each call on the Cortex-M7, tests/timing/results/calls.txt'
	@echo 'make timing-update   records that table in tests/timing/results'
	@echo 'make shared          $(BUILD)/libsmr.so with the functions of smr.h and smr_pthread.h, and no others'
	@echo 'make amalgamation    the library as one source, smr.c and smr.h, in $(BUILD)/amalgamation'
	@echo 'make install         to $$(DESTDIR)$$(PREFIX), default /usr/local; install-core: header and libsmr.a alone,'
	@echo '                     for cross compilers; install-shared: the shared library'
	@echo 'make misra           findings of MISRA C:2012 against docs/safety/MISRA.md; make analyse: GCC'"'"'s analyser'
	@echo 'make prove           readers, indexes and sums of the core for hostile bytes, by frama-c; skipped without it'
	@echo 'make trace           what the last make check said of each requirement of docs/safety, in $(BUILD)/TRACE.md'
	@echo 'make dist            the sources as $(BUILD)/smr-VERSION.tar.gz, the same bytes anywhere; make sbom: its parts, SPDX'
	@echo 'make clean           removes $(BUILD)/'
	@echo 'make WITHOUT="image track"   the library without capabilities: $(CAPABILITIES)'
	@echo 'Variables: CC, CFLAGS (appended), LDFLAGS, BUILD, WERROR=1 (warnings are errors), PREFIX, LIBDIR,'
	@echo '           DESTDIR, V=1 (whole commands; a line for every test program)'

# ---------------------------------------------------------------- objects and libraries

# The core sees its own folders; everything else sees the public header and the ports.
$(BUILD)/obj/src/%.o: src/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) -pedantic $(without:%=-DSMR_WITHOUT_%) -Iinclude -Isrc -c $< -o $@

$(BUILD)/obj/port/%.o: port/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) $(if $(findstring baremetal,$@),,$(THREADS) -pedantic) -Iinclude -Iport/pthread -Ifixtures -c $< -o $@

$(BUILD)/obj/port/host/%.o: port/host/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) $(THREADS) -Iinclude -Iport/host -Iport/pthread -Ifixtures -c $< -o $@

# The page of reports, as arrays of bytes.
$(BUILD)/page/%_page.c: port/host/html/%_page.html $(PAGE_PARTS)
	$(call begin,PAGE,$@)
	$(Q)sh port/host/html/embed_page.sh $< > $@

$(PAGE_OBJ): $(BUILD)/obj/page/%.o: $(BUILD)/page/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) $(THREADS) -Iinclude -Iport/host -Iport/pthread -c $< -o $@

$(BUILD)/obj/fixtures/%.o: fixtures/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) -Ifixtures -c $< -o $@

$(BUILD)/obj/tests/bench/%.o: tests/bench/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) $(THREADS) -Iinclude -Iport/pthread -Iport/host -Ifixtures -Itests/bench -c $< -o $@

# Public header and ports only: this program also runs on the boards.
$(BUILD)/obj/tests/golden/%.o: tests/golden/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) -Iinclude -Iport/pthread -Iport/baremetal -Ifixtures -c $< -o $@

# These look which step the clock is read in, so they see the core's folders, too.
$(BUILD)/obj/tests/target/%.o: tests/target/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) -Iinclude -Isrc -Iport/baremetal -Ifixtures -Itests/target -c $< -o $@

$(BUILD)/obj/tests/%.o: tests/%.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) $(THREADS) -Isrc -Iinclude -Iport/pthread -Iport/host -Ifixtures -Itests -c $< -o $@

$(CORE_LIB): $(CORE_OBJ)
$(PTHREAD_LIB): $(PTHREAD_OBJ)
$(HOST_LIB): $(HOST_OBJ) $(PAGE_OBJ)
$(SUPPORT_LIB): $(SUPPORT_OBJ)
$(CORE_LIB) $(PTHREAD_LIB) $(HOST_LIB) $(SUPPORT_LIB):
	$(call begin,AR,$@)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

# ---------------------------------------------------------------- the shared library, and one source

version := $(shell awk '/define SMR_VERSION_(MAJOR|MINOR|PATCH)/ {v = v s $$3; s = "."} END {print v}' include/smr.h)
# Versions of one series have one interface: each major version begins one; before 1.0 each minor version did.
series  := $(if $(filter 0.%,$(version)),$(basename $(version)),$(firstword $(subst ., ,$(version))))
SHARED_LIB := $(BUILD)/libsmr.so.$(version)

# Calls between the library's own functions cannot be replaced from outside, so they need no detour.
$(BUILD)/pic/%.o: %.c
	$(call begin,CC,$< (shared))
	$(Q)$(CC) $(ALL_CFLAGS) -fPIC -fno-semantic-interposition $(without:%=-DSMR_WITHOUT_%) $(THREADS) -Iinclude -Isrc -c $< -o $@

# What the public headers declare is exported, and nothing else.
$(BUILD)/smr.map: include/smr.h port/pthread/smr_pthread.h
	$(call begin,MAP,$@)
	$(Q)$(CC) -E -P -Iinclude port/pthread/smr_pthread.h | grep -oE 'smr_[a-z0-9_]+ *\(' | sort -u | \
	    awk 'BEGIN { print "{ global:" } { sub(/ *\(/, ";"); print } END { print "local: *; };"; exit !NR }' > $@

$(SHARED_LIB): $(SHARED_OBJ) $(BUILD)/smr.map
	$(call begin,LINK,$@)
	$(Q)$(CC) $(ALL_CFLAGS) $(THREADS) $(LDFLAGS) -shared -Wl,-soname,libsmr.so.$(series) \
	    -Wl,--version-script=$(BUILD)/smr.map -o $@ $(SHARED_OBJ) -lm
	@ln -sf $(@F) $(BUILD)/libsmr.so.$(series) && ln -sf libsmr.so.$(series) $(BUILD)/libsmr.so

shared: $(SHARED_LIB)

amalgamation:
	$(call begin,ONE,$(BUILD)/amalgamation)
	$(Q)sh port/package/amalgamate.sh $(BUILD)/amalgamation

# ---------------------------------------------------------------- programs

# The host's archive calls all others, so it stands before them.
LINK = $(CC) $(ALL_CFLAGS) $(THREADS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter $(HOST_LIB),$^) \
       $(filter-out $(HOST_LIB),$(filter %.a,$^)) $(LDLIBS)

$(BUILD)/smr: $(HOST_MAIN_OBJ) $(HOST_LIB) $(FIXTURE_OBJ) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/fixture_write: $(BUILD)/obj/fixtures/fixture_write.o $(FIXTURE_OBJ)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/golden: $(GOLDEN_OBJ) $(FIXTURE_OBJ) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/answers: $(ANSWERS_OBJ) $(FIXTURE_OBJ) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/faults: $(call obj,$(FAULTS_SRC)) $(SUPPORT_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/replay_run: $(BUILD)/obj/tests/golden/replay_run.o $(PRINT_OBJ) $(FIXTURE_OBJ) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(BUILD)/settings_page: $(BUILD)/obj/tests/docs/settings_page.o $(HOST_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK)

ALL_OBJ += $(call obj,tests/docs/help_pages.c)
$(BUILD)/help_pages: $(BUILD)/obj/tests/docs/help_pages.o $(HOST_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK)

$(HOST_TOOLS): $(BUILD)/tests/host/%: $(BUILD)/obj/tests/host/%.o $(HOST_LIB) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

$(HOST_TESTS) $(BENCHES): $(HOST_LIB)
$(HOST_TESTS): $(call obj,$(HOST_HELPER_SRC))
$(TESTS) $(HOST_TESTS): private LDLIBS += -lcmocka
$(TESTS) $(HOST_TESTS) $(BENCHES): $(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(SUPPORT_LIB) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

# Makes and measures registrations with a known truth; see its usage.
$(CASE_TOOL): $(call obj,$(CASE_SRC)) $(HOST_LIB) $(SUPPORT_LIB) $(PTHREAD_LIB) $(CORE_LIB)
	$(call begin,LINK,$@)
	$(Q)$(LINK) -lm

# Programs for the emulated boards, NAME_BOARD.elf, built with the flags of tests/target/board.sh. A board is a linker script,
# a clock, and a kind of core, which has a start-up. target_flash has the model that check_boards.sh writes as C.
BOARDS   := m3 m4 m7 m33 m55 a53 rv32 rv64
parts_m3 := mps2_an386 port/baremetal/smr_clock_mps2.c port/baremetal/smr_start_m.c port/baremetal/smr_systick.c
parts_m4 := $(parts_m3)
parts_m7  := mps2_an500 $(wordlist 2,4,$(parts_m3))
parts_m33 := mps2_an505 $(wordlist 2,4,$(parts_m3))
parts_m55 := mps3_an547 port/baremetal/smr_clock_mps3.c $(wordlist 3,4,$(parts_m3))
parts_a53 := virt_a64 tests/target/virt_clock.c tests/target/virt_start_a64.c tests/target/virt_memory.c
parts_rv32 := virt_rv tests/target/virt_clock.c tests/target/virt_start_rv.c
parts_rv64 := $(parts_rv32)
BAREMETAL_OBJ := $(call obj,$(addprefix port/baremetal/,smr_baremetal.c smr_semihost.c smr_start.c) $(FIXTURE_SRC))
TARGET_RIG_OBJ := $(call obj,$(filter tests/target/target_rig%,$(TARGET_SRC)))
TARGETS := $(patsubst tests/target/%.c,%,$(filter-out tests/target/target_rig%,$(TARGET_SRC)))
.SECONDARY: $(call obj,$(BAREMETAL_SRC) $(FIXTURE_SRC) $(wildcard tests/target/*.c)) # kept, for the next program
board_elf = $(foreach b,$(BOARDS),$(BUILD)/$(1)_$(b).elf)
FLASH_OBJ := $(BUILD)/obj/tests/target/bone_model.o
$(FLASH_OBJ): $(BUILD)/flash/bone_model.c
	$(call begin,CC,$<)
	$(Q)$(CC) $(ALL_CFLAGS) -c $< -o $@
$(BUILD)/obj/tests/target/target_flash.o: private override ALL_CFLAGS += -I$(BUILD)/flash
$(call board_elf,golden): $(GOLDEN_OBJ)
$(call board_elf,replay_run): $(BUILD)/obj/tests/golden/replay_run.o $(PRINT_OBJ)
$(call board_elf,target_flash): $(FLASH_OBJ)
$(foreach t,$(TARGETS),$(eval $(call board_elf,$(t)): $(call obj,tests/target/$(t).c) $(TARGET_RIG_OBJ)))
define board_rule
$(BUILD)/%_$(1).elf: $$(BAREMETAL_OBJ) $$(call obj,$(wordlist 2,4,$(parts_$(1)))) $$(CORE_LIB) \
                   $$(wildcard port/baremetal/*.ld tests/target/*.ld)
	$$(call begin,LINK,$$@)
	$$(Q)$$(CC) $$(ALL_CFLAGS) -nostartfiles -Wl,--gc-sections -L port/baremetal -L tests/target \
	    -T $(word 1,$(parts_$(1))).ld -o $$@ $$(filter %.o,$$^) $$(CORE_LIB) -lm -lc -lgcc
endef
$(foreach b,$(BOARDS),$(eval $(call board_rule,$(b))))

# ---------------------------------------------------------------- what people call

demo: $(BUILD)/fixture_write $(PROGRAM)
	@sh tests/demo.sh $(BUILD)

demo-bone: $(BUILD)/fixture_write $(PROGRAM)
	@sh tests/demo_bone.sh $(BUILD)

# CMocka must be there before a test is compiled, so it is an order-only prerequisite.
cmocka:
	@$(if $(TEST_SRC)$(HOST_TEST_SRC),sh tests/need_cmocka.sh "$(CC)",:)

$(call obj,$(TEST_SRC) $(HOST_TEST_SRC) $(HOST_HELPER_SRC)): | cmocka

# What tests/check_layers.sh reads symbols from; it gives a BUILD and CFLAGS of its own.
layer-objects: $(CORE_OBJ) $(HOST_OBJ) $(HOST_MAIN_OBJ)

programs: all $(TESTS) $(HOST_TESTS) $(HOST_TOOLS) $(CASE_TOOL) $(BUILD)/fixture_write $(BUILD)/golden $(BUILD)/answers $(BUILD)/replay_run \
          $(BUILD)/faults \
          $(BUILD)/settings_page $(call obj,$(wildcard port/template/*.c))

run_checks = BUILD="$(BUILD)" CC="$(CC)" NM="$(NM)" SMR="$(BUILD)/smr" \
             CFLAGS="$(CFLAGS)" V="$(V)" sh tests/run_checks.sh

# Experiments that take long run in `make experiments` alone, in full.
check: programs
	@$(run_checks) $(EXPERIMENTS) $(TESTS) $(HOST_TESTS)

.PHONY: check-html
check-html: $(PROGRAM)
	@SMR="$(BUILD)/smr" BUILD="$(BUILD)" sh tests/html/check_html.sh

UNIT_TESTS := $(filter $(BUILD)/tests/unit/%,$(TESTS))
check-quick: all $(UNIT_TESTS) $(BUILD)/golden $(BUILD)/answers
	@$(run_checks) --quick $(UNIT_TESTS)

faults: $(BUILD)/faults $(PROGRAM) $(HOST_TOOLS) $(BUILD)/tests/property/test_combinations
	@for kind in bare seal; do echo "$$kind:"; $(BUILD)/faults $(or $(N),100000) $(or $(SEED),1) $$kind || exit 1; done
	@for part in stop failing; do BUILD="$(BUILD)" SMR="$(BUILD)/smr" CC="$(CC)" SMR_FULL=1 sh tests/host/test_host_$$part.sh || exit 1; done
	@SMR_TEST_CHAOS=40 $(BUILD)/tests/property/test_combinations

.PHONY: fuzz
SECONDS ?= 60
fuzz:
	@BUILD="$(BUILD)" MAKE="$(MAKE)" CC="$(CC)" sh tests/fuzz/fuzz.sh $(SECONDS) $(KEEP)

experiments: all $(CASE_TOOL)
	@BUILD="$(BUILD)" SMR="$(BUILD)/smr" CFLAGS="$(CFLAGS)" sh $(EXPERIMENTS) full

# Every figure that a document names: docs/RESULTS.md and README's table. The short form leaves out what takes minutes.
.PHONY: results results-short
results results-short: all $(BUILD)/fixture_write $(CASE_TOOL) $(BENCHES) $(BUILD)/tests/property/test_properties
	@BUILD="$(BUILD)" MAKE="$(MAKE)" CC="$(CC)" sh tests/results/results.sh $(if $(findstring short,$@),short,all)

# Other programs' results; elastix needs minutes.
.PHONY: peers
peers:
	@$(MAKE) -s results-short PARTS='peers elastix'

bench: $(BENCHES)
	@BUILD="$(BUILD)" sh tests/run_bench.sh $(BENCHES)

figure1 figure2: $(PROGRAM)
	$(Q)$(BUILD)/smr bench --$@ -o docs/figures
	$(Q)python3 docs/figures/make_plots.py $@

# Python's standard library, gcc and gcov. The map of lines is made anew when a source is younger.
.PHONY: coverage mutants
N ?= 200
SEED ?= 1
coverage_tools = @MAKE="$(MAKE)" python3 tests/coverage
coverage:
	$(coverage_tools)/coverage.py $(BUILD)
	$(coverage_tools)/mcdc.py $(BUILD)

$(BUILD)/coverage/map.json: $(CORE_SRC) $(TEST_SRC)
	$(coverage_tools)/coverage.py $(BUILD)

mutants: $(BUILD)/coverage/map.json
	$(coverage_tools)/mutants.py $(BUILD) $(N) $(SEED)

soak: $(PROGRAM)
	$(Q)$(BUILD)/smr bench --soak -o $(BUILD)/soak

size: $(CORE_LIB)
	@BUILD="$(BUILD)" MAKE="$(MAKE)" CC="$(CC)" CFLAGS="$(CFLAGS)" SIZE="$(SIZE)" sh tests/size/size.sh

# STACK: a build by gcc with -fstack-usage.
STACK ?= $(BUILD)/stack
stack:
	@$(MAKE) -s BUILD=$(STACK) CC=gcc CFLAGS=-fstack-usage $(STACK)/libsmr.a
	@sh tests/check_stack.sh $(STACK)/obj/src "$$(gcc -dumpmachine)"
	@if command -v arm-none-eabi-gcc >/dev/null; then \
	    $(MAKE) -s BUILD=$(M7_BOARD) CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
	        CFLAGS="$(M7_CFLAGS) -O2" $(M7_BOARD)/libsmr.a && \
	    sh tests/check_stack.sh $(M7_BOARD)/obj/src Cortex-M7; \
	else echo 'Cortex-M7: skipped (needs gcc-arm-none-eabi)'; fi

hashes:
	@MAKE="$(MAKE)" BUILD="$(BUILD)" sh tests/golden/hashes.sh

# What smr writes, read by ITK in a C++ program by CMake.
.PHONY: check-itk
check-itk: $(PROGRAM) $(HOST_TOOLS)
	@BUILD="$(BUILD)" SMR="$(BUILD)/smr" sh tests/itk/itk.sh || [ $$? -eq 77 ]

settings-page: $(BUILD)/settings_page
	$(Q)$(BUILD)/settings_page > $(BUILD)/SETTINGS.md
	@echo 'written: $(BUILD)/SETTINGS.md'

.PHONY: man reference install-man
programs: $(BUILD)/help_pages
write_man = mkdir -p $(BUILD)/man && $(BUILD)/help_pages | awk -v dir=$(BUILD)/man -f tests/docs/help_pages.awk
man: $(BUILD)/help_pages
	$(Q)$(write_man)

# Not where another machine's program would have to write them.
install: $(if $(PROGRAM),install-man)
install-man: $(BUILD)/help_pages
	$(Q)if $(write_man) 2>/dev/null; then \
	    install -d $(addprefix '$(DESTDIR)$(PREFIX)'/share/,man/man1 bash-completion/completions zsh/site-functions) && \
	    install -m 644 $(BUILD)/man/*.1 '$(DESTDIR)$(PREFIX)/share/man/man1' && \
	    install -m 644 $(BUILD)/man/smr.bash '$(DESTDIR)$(PREFIX)/share/bash-completion/completions/smr' && \
	    install -m 644 $(BUILD)/man/_smr '$(DESTDIR)$(PREFIX)/share/zsh/site-functions'; \
	else echo 'no man pages: $(BUILD)/help_pages does not run here'; fi

reference:
	$(Q)mkdir -p $(BUILD) && sh tests/docs/reference.sh include/smr.h > $(BUILD)/reference.html

.PHONY: api-update
api-update:
	@CC="$(CC)" sh tests/check_api.sh --update

# Files of the version in smr.h, before its release.
.PHONY: kept-update
kept-update: $(PROGRAM)
	@BUILD="$(BUILD)" SMR="$(BUILD)/smr" sh tests/golden/check_kept.sh --update

golden-update: $(BUILD)/golden $(BUILD)/answers
	$(Q)$(BUILD)/answers > $(BUILD)/answers.txt && cp $(BUILD)/answers.txt tests/golden
	$(Q)$(BUILD)/golden > tests/golden/expected.txt
	@cat tests/golden/expected.txt

boards: $(BUILD)/fixture_write $(PROGRAM)
	@BUILD="$(BUILD)" sh tests/target/boards.sh

timing:
	@for board in m7 m55; do for program in target_budget target_interrupt; do \
	    BUILD="$(BUILD)" sh tests/target/check_boards.sh $$board $$program 10000 || exit 1; done; done
	@BUILD="$(BUILD)" sh tests/target/check_timing.sh

# N ticks with budgets of 0.05 to 2 ms: 10^6 take a quarter of an hour.
timing-ticks: $(BUILD)/fixture_write $(PROGRAM)
	@BUILD="$(BUILD)" SMR_BOARD_SECONDS=7200 sh tests/target/check_boards.sh m7 target_ticks $(or $(N),1000000)

timing-calls: $(BUILD)/fixture_write $(PROGRAM)
	@BUILD="$(BUILD)" sh tests/timing/calls.sh

timing-update:
	@BUILD="$(BUILD)" sh tests/target/check_timing.sh --update

# Archives: who links them needs what they need, which smr.pc and smrConfig.cmake say.
put = BUILD='$(BUILD)' DESTDIR='$(DESTDIR)' PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' VERSION=$(version) SERIES=$(series) \
      sh port/package/install.sh
install: all
	$(call begin,INST,$(DESTDIR)$(PREFIX))
	$(Q)$(put) core pthread $(if $(PROGRAM),program)

install-core: $(CORE_LIB)
	$(call begin,INST,$(DESTDIR)$(PREFIX))
	$(Q)$(put) core

install-shared: $(SHARED_LIB)
	$(call begin,INST,$(DESTDIR)$(PREFIX))
	$(Q)$(put) shared

# cppcheck with Python: half a minute of processor time. The analyser takes as long.
.PHONY: misra analyse trace prove
misra:
	@python3 tests/misra/misra.py $(BUILD)/misra || [ $$? -eq 77 ]

analyse:
	@sh tests/misra/analyse.sh || [ $$? -eq 77 ]

# frama-c: three minutes of processor time.
prove:
	@BUILD="$(BUILD)" CC="$(CC)" sh tests/prove/prove.sh

trace:
	@BUILD="$(BUILD)" sh tests/check_requirements.sh --ran

DIST := smr-$(version)
.PHONY: dist sbom
dist:
	$(call begin,DIST,$(BUILD)/$(DIST).tar.gz)
	$(Q)mkdir -p $(BUILD) && sh port/package/dist.sh archive $(DIST) $(BUILD)/$(DIST).tar.gz

sbom: dist
	$(call begin,SBOM,$(BUILD)/$(DIST).spdx)
	$(Q)sh port/package/dist.sh sbom $(DIST) $(BUILD)/$(DIST).tar.gz > $(BUILD)/$(DIST).spdx

clean:
	$(Q)rm -rf $(BUILD)

-include $(ALL_OBJ:.o=.d)
