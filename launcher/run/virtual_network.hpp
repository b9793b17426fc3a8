// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/run/run_plan.hpp"

#include <map>
#include <string>

namespace gridspace::launcher {

/// Hosts and switches of a run: a network namespace per host, a bridge per link, joined by veth pairs. Lives in the
/// namespaces of the calling process (which must own them) and goes with them. Needs `ip` of iproute2.
class VirtualNetwork {
  public:
    VirtualNetwork() = default;
    VirtualNetwork(VirtualNetwork const&) = delete;
    VirtualNetwork& operator=(VirtualNetwork const&) = delete;
    ~VirtualNetwork();

    /// All links are up, with carrier, when it returns, but for real interfaces whose cable has none.
    [[nodiscard]] Result<void> build(RunPlan const& plan);

    /// The namespace of a host as a file descriptor for setns().
    [[nodiscard]] int host(std::string const& name) const { return hosts_.at(name); }

  private:
    [[nodiscard]] Result<int> make_namespace();
    /// Takes the real interfaces of the plan into their hosts. When the run is over the kernel gives them back.
    [[nodiscard]] Result<void> take_interfaces(RunPlan const& plan, std::map<std::string, std::string>& inside) const;
    /// Takes a real interface to the switches, in the place of a host's cable. When the run is over the kernel gives it
    /// back.
    [[nodiscard]] Result<void> plug(RunPlan const& plan, Port const& port) const;
    /// The commands for the cable between a port and the switch; `inside`: what is to be done in each host.
    [[nodiscard]] std::string cable(RunPlan const& plan, Port const& port, std::string const& switch_end,
                                    std::map<std::string, std::string>& inside) const;
    /// The kernel looks at new carriers up to a second later, and until then a switch drops what its port gets.
    void open_switch_ports(RunPlan const& plan) const;
    [[nodiscard]] Result<void> prepare_ip_cables(RunPlan const& plan) const;
    enum class AfterError { stop, go_on };
    [[nodiscard]] Result<void> ip(int netns, std::string const& batch, AfterError after = AfterError::stop) const;
    int own_{-1};
    std::map<std::string, int> hosts_;
};

} // namespace gridspace::launcher
