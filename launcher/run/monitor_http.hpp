// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/monitor_client.hpp"

#include <string>
#include <string_view>

namespace gridspace::launcher {

struct MonitorReply {
    unsigned status{0};
    std::string body;
};

/// One request to a monitor and its whole answer. `token` and `content` may be empty. With TLS, whoever shows another
/// certificate than the monitor's (or one that it vouches for) is not talked to; names are not looked at. An error says
/// whether nobody answers, somebody else does, it says nothing for `patience`, or its answer was cut.
[[nodiscard]] Result<MonitorReply> exchange(MonitorAddress const& monitor, std::string_view method,
                                            std::string_view path, std::string const& token, std::string content,
                                            std::chrono::milliseconds patience);

} // namespace gridspace::launcher
