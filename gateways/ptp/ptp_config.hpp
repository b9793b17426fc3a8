// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <optional>
#include <string>

namespace gridspace::ptp {

/// `ptp:` of a process that sends sampled values, in real time: the daemon that disciplines the clock of its machine.
struct PtpConfig {
    std::string socket{"/run/ptp4l"};
    std::int64_t domain{0};
    double within_us{50}, holdover_s{5};
};
void describe_ptp(config::Fields& f, std::optional<PtpConfig>& ptp);

} // namespace gridspace::ptp
