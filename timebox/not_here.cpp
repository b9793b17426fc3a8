// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/box.hpp"

namespace gridspace::timebox {

Result<BoxReport> run_in_simulated_time(BoxOptions const&) {
    return fail(ExitCode::environment, "programs in simulated time run on x86-64 only");
}

} // namespace gridspace::timebox
