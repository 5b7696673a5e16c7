/* test_status.c: every status has a name of its own, and every other number the name of an unknown one.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "smr.h"

TEST(names)
{
    static const struct {
        smr_status status;
        const char *name;
    } table[] = {
        {SMR_OK, "SMR_OK"},
        {SMR_PARTIAL, "SMR_PARTIAL"},
        {SMR_E_NULL, "SMR_E_NULL"},
        {SMR_E_CONFIG, "SMR_E_CONFIG"},
        {SMR_E_ARENA, "SMR_E_ARENA"},
        {SMR_E_ALIGN, "SMR_E_ALIGN"},
        {SMR_E_MODEL, "SMR_E_MODEL"},
        {SMR_E_INPUT, "SMR_E_INPUT"},
        {SMR_E_STATE, "SMR_E_STATE"},
        {SMR_E_ABORTED, "SMR_E_ABORTED"},
        {SMR_E_LOG, "SMR_E_LOG"},
        {SMR_E_SAVE, "SMR_E_SAVE"},
        {SMR_E_WITHOUT, "SMR_E_WITHOUT"},
        {SMR_E_DAMAGED, "SMR_E_DAMAGED"},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        assert_string_equal(smr_status_name(table[i].status), table[i].name);
    for (int i = -12; i < 0; i++) /* refusals are negative, the two others are not */
        assert_int_equal(strncmp(smr_status_name((smr_status)i), "SMR_E_", 6), 0);
    assert_string_equal(smr_status_name((smr_status)2), "SMR_E_UNKNOWN");
    assert_string_equal(smr_status_name((smr_status)-13), "SMR_E_UNKNOWN");
}
