// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/virtual_network.hpp"

#include "common/unique_fd.hpp"
#include "launcher/run/offloads.hpp"
#include "launcher/scenario/guest.hpp"
#include "launcher/scenario/installation.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <set>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

std::string error_text() {
    return std::strerror(errno);
}

/// Of this network alone, as far as the kernel has it.
void set_kernel(char const* setting, char const* value) {
    if (UniqueFd const file{::open(setting, O_WRONLY | O_CLOEXEC)}; file) {
        [[maybe_unused]] auto const written = ::write(file.get(), value, 1);
    }
}

/// Frames that nobody asked for (router solicitations, neighbour discovery) would make captures differ.
void disable_ipv6() {
    set_kernel("/proc/sys/net/ipv6/conf/all/disable_ipv6", "1");
    set_kernel("/proc/sys/net/ipv6/conf/default/disable_ipv6", "1");
}

/// A switch looks at no IP. Where the kernel has br_netfilter it does: takes padding off, drops what has a wrong
/// checksum.
void leave_ip_alone() {
    set_kernel("/proc/sys/net/bridge/bridge-nf-call-iptables", "0");
    set_kernel("/proc/sys/net/bridge/bridge-nf-call-ip6tables", "0");
}

/// Everybody on a link knows the MAC addresses of the others, so nobody asks: captures hold no ARP. The kernel's table
/// of neighbours is one for all namespaces of a machine and holds `gc_thresh3` entries (1024), some 23 hosts who found
/// each other by ARP; permanent entries do not count. A real board (`plugs:`) has an address of its own and is asked
/// for it.
std::string permanent_neighbours(std::vector<Port> const& ports, Port const& port) {
    // The groups that every process joins or sends to are entries of each interface too: IGMP, DDS discovery, our
    // topics.
    std::string commands;
    for (auto const& [group, mac] : {std::pair{"224.0.0.22", "01:00:5e:00:00:16"},
                                     {"239.255.0.1", "01:00:5e:7f:00:01"},
                                     {"239.255.0.2", "01:00:5e:7f:00:02"}}) {
        commands += fmt::format("neigh replace {} lladdr {} nud permanent dev {}\n", group, mac, port.interface);
    }
    for (Port const& other : ports) {
        if (other.link == port.link && other.host != port.host && !other.address.empty() && other.plug.empty()) {
            commands += fmt::format("neigh replace {} lladdr {} nud permanent dev {}\n", other.address, other.mac,
                                    port.interface);
        }
    }
    return commands;
}

std::string bridge_name(std::size_t link) {
    return fmt::format("br{}", link);
}

/// The management link, then those of the scenario: by number of their bridge.
std::vector<std::string> links_of(RunPlan const& plan) {
    std::vector<std::string> links{std::string{kManagementLink}};
    for (Link const& link : plan.links) {
        links.push_back(link.name.name);
    }
    return links;
}

/// The commands that make the switches. `boxed_ip_links`: on which programs in simulated time speak IP.
std::string bridges(std::vector<std::string> const& links, std::set<std::string> const& boxed_ip_links) {
    std::string commands;
    for (std::size_t l = 0; l < links.size(); ++l) {
        // A frame in simulated time is waited for at every port that takes its kind: such a switch remembers nobody's
        // place, and gives each frame to all.
        commands += fmt::format("link add name {0} type bridge mcast_snooping 0 stp_state 0{1}\nlink set dev {0} up\n",
                                bridge_name(l), boxed_ip_links.contains(links[l]) ? " ageing_time 0" : "");
    }
    return commands;
}

std::set<std::string> hosts_of_guests(RunPlan const& plan) {
    std::set<std::string> guests;
    for (PlannedProcess const& process : plan.processes) {
        if (process.is_guest) {
            guests.insert(process.host);
        }
    }
    return guests;
}

} // namespace

VirtualNetwork::~VirtualNetwork() {
    for (auto const& [name, fd] : hosts_) {
        ::close(fd);
    }
    if (own_ >= 0) {
        ::close(own_);
    }
}

Result<int> VirtualNetwork::make_namespace() {
    if (::unshare(CLONE_NEWNET) != 0) {
        return fail(ExitCode::environment, fmt::format("cannot make a network namespace: {}", error_text()),
                    "`gridspace run --no-namespaces` runs scenarios without raw frames on the loopback interface");
    }
    disable_ipv6();
    int const fd = ::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC);
    int const back = ::setns(own_, CLONE_NEWNET);
    if (fd < 0 || back != 0) {
        return fail(ExitCode::environment, fmt::format("cannot use a network namespace: {}", error_text()));
    }
    return fd;
}

Result<void> VirtualNetwork::ip(int netns, std::string const& batch, AfterError after) const {
    static std::filesystem::path const program = system_program("ip");
    if (program.empty()) {
        return fail(ExitCode::environment, "the program `ip` is missing", "install the package iproute2");
    }
    int input[2], output[2];
    if (::pipe2(input, O_CLOEXEC) != 0 || ::pipe2(output, O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", error_text()));
    }
    pid_t const pid = ::fork();
    if (pid == 0) {
        ::dup2(input[0], STDIN_FILENO);
        ::dup2(output[1], STDOUT_FILENO);
        ::dup2(output[1], STDERR_FILENO);
        for (auto const& [name, fd] : hosts_) {
            ::fcntl(fd, F_SETFD, 0); // named as /proc/self/fd/N in the batch
        }
        if (::setns(netns, CLONE_NEWNET) == 0) {
            ::execl(program.c_str(), "ip", "-batch", "-", after == AfterError::go_on ? "-force" : nullptr, nullptr);
        }
        ::_exit(127);
    }
    ::close(input[0]);
    ::close(output[1]);
    std::size_t sent = 0;
    while (sent < batch.size()) {
        ssize_t const n = ::write(input[1], batch.data() + sent, batch.size() - sent);
        if (n <= 0) {
            break;
        }
        sent += static_cast<std::size_t>(n);
    }
    ::close(input[1]);
    std::string printed;
    char buffer[1024];
    for (ssize_t n = 0; (n = ::read(output[0], buffer, sizeof buffer)) > 0;) {
        printed.append(buffer, static_cast<std::size_t>(n));
    }
    ::close(output[0]);
    int status = 0;
    ::waitpid(pid, &status, 0);
    if (status != 0) {
        std::replace(printed.begin(), printed.end(), '\n', ' ');
        return fail(ExitCode::environment, fmt::format("the virtual network could not be made: {}", printed),
                    "`gridspace doctor` checks what the kernel allows");
    }
    return {};
}

Result<void> VirtualNetwork::take_interfaces(RunPlan const& plan, std::map<std::string, std::string>& inside) const {
    std::set<std::string> taken;
    for (PlannedProcess const& process : plan.processes) {
        if (process.interface.empty() || !taken.insert(process.interface).second) {
            continue;
        }
        if (auto ok = ip(plan.outer_network, fmt::format("link set dev {} netns /proc/self/fd/{}\n", process.interface,
                                                         hosts_.at(process.host)));
            !ok) {
            return fail(ok.error().code,
                        fmt::format("process '{}' cannot have the interface '{}': {}", process.name, process.interface,
                                    ok.error().message),
                        "does `ip link` show it, and is this run started as root?");
        }
        inside[process.host] += fmt::format("link set dev {} up\n", process.interface);
    }
    return {};
}

Result<void> VirtualNetwork::plug(RunPlan const& plan, Port const& port) const {
    // This process is process 1 of its namespaces, and lives where the switches are.
    if (auto ok = ip(plan.outer_network, fmt::format("link set dev {} netns 1\n", port.plug)); !ok) {
        return fail(ok.error().code,
                    fmt::format("the interface '{}' cannot be plugged into '{}' for host '{}': {}", port.plug,
                                port.link, port.host, ok.error().message),
                    "does `ip link` show it, and is this run started as root?");
    }
    return {};
}

std::string VirtualNetwork::cable(RunPlan const& plan, Port const& port, std::string const& switch_end,
                                  std::map<std::string, std::string>& inside) const {
    struct End {
        std::string interface, host;
    };
    // From the host to the switch: each piece of the cable ends where somebody sits in it.
    std::string commands;
    End near{fmt::format("{} address {}", port.interface, port.mac), port.host};
    for (PlacedBump const& bump : plan.bumps) {
        if (bump.host != port.host || bump.link != port.link) {
            continue;
        }
        commands +=
            fmt::format("link add name {} netns /proc/self/fd/{} type veth peer name {} netns /proc/self/fd/{}\n",
                        bump.host_interface, hosts_.at(bump.process_host), near.interface, hosts_.at(near.host));
        for (std::string const& interface : {bump.host_interface, bump.switch_interface}) {
            inside[bump.process_host] += fmt::format("link set dev {} promisc on up\n", interface);
        }
        near = {bump.switch_interface, bump.process_host};
    }
    return commands + fmt::format("link add name {} type veth peer name {} netns /proc/self/fd/{}\n", switch_end,
                                  near.interface, hosts_.at(near.host));
}

Result<void> VirtualNetwork::build(RunPlan const& plan) {
    own_ = ::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC);
    if (own_ < 0) {
        return fail(ExitCode::environment, fmt::format("cannot open the network namespace: {}", error_text()));
    }
    disable_ipv6();
    leave_ip_alone();
    for (std::string const& host : plan.hosts) {
        auto fd = make_namespace();
        if (!fd) {
            return std::unexpected{fd.error()};
        }
        hosts_[host] = *fd;
    }
    std::vector<std::string> const links = links_of(plan);
    std::string core = "link set lo up\n" + bridges(links, plan.boxed_ip_links);
    std::map<std::string, std::string> inside;
    std::set<std::string> const guests = hosts_of_guests(plan);
    std::map<std::string, std::size_t> handed_over;
    for (std::size_t p = 0; p < plan.ports.size(); ++p) {
        Port const& port = plan.ports[p];
        auto const link = static_cast<std::size_t>(std::find(links.begin(), links.end(), port.link) - links.begin());
        std::string const outer = switch_port_name(p);
        if (!port.plug.empty()) {
            if (auto ok = plug(plan, port); !ok) {
                return ok;
            }
            core += fmt::format("link property add dev {} altname {}\nlink set dev {} promisc on master {} up\n",
                                port.plug, outer, port.plug, bridge_name(link));
            continue;
        }
        core += cable(plan, port, outer, inside);
        core += fmt::format("link set dev {} master {} up\n", outer, bridge_name(link));
        std::string& commands = inside[port.host];
        if (guests.contains(port.host)) {
            commands += guest::hand_over(port, handed_over[port.host]++, ::geteuid());
            continue;
        }
        commands += fmt::format("link set dev {} up\n", port.interface);
        if (!port.address.empty()) {
            commands += fmt::format("addr add {}/{} dev {}\n", port.address, port.prefix, port.interface);
            commands += permanent_neighbours(plan.ports, port);
        }
    }
    if (auto ok = ip(own_, core); !ok) {
        return ok;
    }
    if (auto ok = take_interfaces(plan, inside); !ok) {
        return ok;
    }
    for (auto const& [host, commands] : inside) {
        if (auto ok = ip(hosts_.at(host), "link set lo up\n" + commands); !ok) {
            return ok;
        }
    }
    open_switch_ports(plan);
    return prepare_ip_cables(plan);
}

void VirtualNetwork::open_switch_ports(RunPlan const& plan) const {
    std::string commands;
    for (std::size_t p = 0; p < plan.ports.size(); ++p) {
        commands += fmt::format("link set dev {} type bridge_slave state 3\n", switch_port_name(p));
    }
    // One that is refused has no carrier: the kernel opens it when the cable is plugged in.
    [[maybe_unused]] auto const opened = ip(own_, commands, AfterError::go_on);
}

/// Cables that carry IP and have somebody in them.
Result<void> VirtualNetwork::prepare_ip_cables(RunPlan const& plan) const {
    for (std::size_t p = 0; p < plan.ports.size(); ++p) {
        Port const& port = plan.ports[p];
        bool const cut = std::any_of(plan.bumps.begin(), plan.bumps.end(),
                                     [&](PlacedBump const& c) { return c.host == port.host && c.link == port.link; });
        if (!cut || port.address.empty()) {
            continue;
        }
        if (auto ok = finish_frames_before_sending(hosts_.at(port.host), port.interface); !ok) {
            return ok;
        }
        if (auto ok = finish_frames_before_sending(own_, switch_port_name(p)); !ok) {
            return ok;
        }
    }
    return {};
}

} // namespace gridspace::launcher
