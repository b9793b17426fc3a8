// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "launcher/scenario/addresses.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

struct Scenario;
struct Process;

/// `ready:` of somebody's own program: the run begins when its output holds this text.
struct Readiness {
    config::Ref says;
    double within_s{60};
};
void describe(config::Fields& f, Readiness& out);

/// `guest: true`: a virtual machine that stands for a host. Each interface of the host is handed to it as a tap device,
/// bridged to the cable; what is in the guest has the interface's MAC address.
namespace guest {

/// The tap that stands for an interface: of the n-th port of its host.
[[nodiscard]] std::string tap_name(std::size_t n);

/// A word of its command with `{folder}` replaced: the machine's files lie next to the file that names them.
[[nodiscard]] std::string in_folder(std::string word, std::string const& folder);

/// The words of its command with `{tap:LINK}` and `{mac:LINK}` replaced.
[[nodiscard]] std::vector<std::string> command(std::vector<std::string> words, std::vector<Port> const& ports,
                                               std::string const& host);

/// Commands of `ip -batch` in the host, which hand an interface over. `owner`: the user who may open the tap.
[[nodiscard]] std::string hand_over(Port const& port, std::size_t n, unsigned owner);

/// A guest has its host to itself, and its command names links that the host has.
void check(Scenario const& scenario, Process const& process, std::vector<config::Ref> const& words,
           config::Diagnostics& diagnostics);

} // namespace guest
} // namespace gridspace::launcher
