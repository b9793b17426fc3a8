// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <string>

namespace gridspace::launcher {

struct ListeningSocket {
    UniqueFd fd;
    std::string address; ///< "127.0.0.1:40123"
};

/// Opens a TCP socket that listens on "address:port"; port 0 is a free one. It is opened outside of the run's
/// namespaces and handed to the process that serves, so that it is reachable from outside.
[[nodiscard]] Result<ListeningSocket> open_listening(std::string const& where);

} // namespace gridspace::launcher
