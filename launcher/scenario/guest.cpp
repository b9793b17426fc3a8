// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/guest.hpp"

#include "common/text.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <optional>

namespace gridspace::launcher {

void describe(config::Fields& f, Readiness& out) {
    f.reference("says", out.says, {.doc = "text in its output", .required = true});
    f.number("within_s", out.within_s, {.doc = "how long that may take", .above = 0});
}

namespace guest {
namespace {

constexpr std::array<std::string_view, 2> kKinds{"{tap:", "{mac:"};
constexpr std::string_view kFolder = "{folder}";

/// Calls replace(kind, link) for each placeholder, and puts what it gives in its place.
template <class Replace>
std::string each_placeholder(std::string_view word, Replace const& replace) {
    std::string out;
    while (!word.empty()) {
        auto const kind = std::ranges::find_if(kKinds, [&](std::string_view k) { return word.starts_with(k); });
        std::size_t const end = kind == kKinds.end() ? std::string_view::npos : word.find('}');
        if (end == std::string_view::npos) {
            out += word.front();
            word.remove_prefix(1);
            continue;
        }
        out += replace(*kind, std::string{word.substr(kind->size(), end - kind->size())});
        word.remove_prefix(end + 1);
    }
    return out;
}

std::vector<Port const*> ports_of(std::vector<Port> const& ports, std::string const& host) {
    std::vector<Port const*> out;
    for (Port const& port : ports) {
        if (port.host == host) {
            out.push_back(&port);
        }
    }
    return out;
}

} // namespace

std::string tap_name(std::size_t n) {
    return fmt::format("tap{}", n);
}

std::string in_folder(std::string word, std::string const& folder) {
    for (std::size_t at = 0; (at = word.find(kFolder, at)) != std::string::npos; at += folder.size()) {
        word.replace(at, kFolder.size(), folder);
    }
    return word;
}

std::vector<std::string> command(std::vector<std::string> words, std::vector<Port> const& ports,
                                 std::string const& host) {
    auto const own = ports_of(ports, host);
    for (std::string& word : words) {
        word = each_placeholder(word, [&](std::string_view kind, std::string const& link) -> std::string {
            auto const at = std::ranges::find_if(own, [&](Port const* port) { return port->link == link; });
            if (at == own.end()) {
                return {}; // check() has said so
            }
            return kind == kKinds[0] ? tap_name(static_cast<std::size_t>(at - own.begin())) : (*at)->mac;
        });
    }
    return words;
}

std::string hand_over(Port const& port, std::size_t n, unsigned owner) {
    // The end of the cable has another address than the guest, or the bridge would take the guest's frames for its own.
    return fmt::format("link set dev {0} down\nlink set dev {0} address 06:{1}\n"
                       "link add name bridge{2} type bridge mcast_snooping 0 stp_state 0\n"
                       "tuntap add dev {3} mode tap user {4}\nlink set dev {3} master bridge{2} up\n"
                       "link set dev {0} master bridge{2} up\nlink set dev bridge{2} up\n",
                       port.interface, port.mac.substr(3), n, tap_name(n), owner);
}

void check(Scenario const& scenario, Process const& process, std::vector<config::Ref> const& words,
           config::Diagnostics& diagnostics) {
    if (process.run_on != "native") {
        diagnostics.error(process.name.where,
                          fmt::format("process '{}' is a guest and runs on '{}'", process.name.name, process.run_on),
                          "`run_on: native`: its command starts the machine here");
    }
    if (!process.interface.empty()) {
        diagnostics.error(process.name.where,
                          fmt::format("process '{}' is a guest, and has the real interface '{}'", process.name.name,
                                      process.interface),
                          "leave out `interface`: a guest has a tap for each link of its host");
    }
    for (Process const& other : scenario.processes) {
        if (&other != &process && other.host.name == process.host.name) {
            diagnostics.error(process.name.where,
                              fmt::format("process '{}' is a guest in the place of host '{}', where '{}' runs",
                                          process.name.name, process.host.name, other.name.name),
                              "give one of both another host");
            break;
        }
    }
    std::vector<Port> const ports = plan_ports(scenario);
    auto const own = ports_of(ports, process.host.name);
    std::vector<std::string> links;
    for (Port const* port : own) {
        links.push_back(port->link);
    }
    for (config::Ref const& word : words) {
        each_placeholder(word.name, [&](std::string_view kind, std::string const& link) {
            if (std::ranges::find(links, link) == links.end()) {
                diagnostics.error(word.where,
                                  fmt::format("process '{}': '{}{}}}' names a link that host '{}' is not plugged into",
                                              process.name.name, kind, link, process.host.name),
                                  spelling_hint(link, links), static_cast<int>(word.name.size()));
            }
            return std::string{};
        });
    }
}

} // namespace guest
} // namespace gridspace::launcher
