// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// The functions that take the place of those of the vDSO. They are copied to the page behind the ClockPage.
extern "C" {
extern char const gridspace_clock_begin[], gridspace_clock_gettime[], gridspace_gettimeofday[], gridspace_time[],
    gridspace_getrandom[], gridspace_clock_end[];
}
