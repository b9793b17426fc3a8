// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/control_gateway.hpp"

#include <algorithm>
#include <controls.h>

namespace gridspace::sim {
namespace {

/// Real time: so many samples may wait for a time to come. Of more, the last do not count.
constexpr std::size_t kMaxWaiting = 4096;

} // namespace

/// A topic, and what of it waits for its time (real time; in lockstep the reader keeps it).
template <class T>
struct ControlGateway::Inbound {
    std::shared_ptr<bus::Reader<T>> reader;
    std::vector<bus::Received<T>> waiting; ///< by time, then as they came
};

ControlGateway::ControlGateway(bus::Node& node, Controls controls, SimTime end)
    : node_{node}, controls_{std::move(controls)}, end_{end} {}
ControlGateway::~ControlGateway() = default;

Result<std::unique_ptr<ControlGateway>> ControlGateway::create(bus::Node& node, Network const& network,
                                                               std::vector<ControlConfig> const& configs, bool waveform,
                                                               Control::Grid const& grid) {
    auto gateway =
        std::unique_ptr<ControlGateway>{new ControlGateway{node, Controls{configs, network, waveform, grid}, grid.end}};
    auto const open = [&]<class T>(std::unique_ptr<Inbound<T>>& inbound, char const* topic) -> Result<void> {
        auto reader = node.reader<T>(topic);
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        inbound = std::make_unique<Inbound<T>>();
        inbound->reader = std::move(*reader);
        return {};
    };
    bool const commands = std::any_of(configs.begin(), configs.end(), [](auto const& c) { return c.quantity.empty(); });
    bool const values = std::any_of(configs.begin(), configs.end(), [](auto const& c) { return !c.quantity.empty(); });
    if (auto ok = values ? open(gateway->set_points_, "set_points") : Result<void>{}; !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = commands ? open(gateway->commands_, "commands") : Result<void>{}; !ok) {
        return std::unexpected{ok.error()};
    }
    return gateway;
}

template <class T, class Pass>
void ControlGateway::pass_on(Inbound<T>& inbound, Simulation const& simulation, SimTime until, Pass const& pass) {
    auto& waiting = inbound.waiting;
    auto const tell = [&](bus::Received<T> const& received) {
        T const& sample = received.value;
        std::string const process = node_.process_name(received.origin);
        pass(Controls::Asked{std::max(std::min(received.origin.time, until), simulation.now()), received.origin.time,
                             process, sample.source().c_str(), sample.element().c_str(), sample.valid_for_s()},
             sample);
    };
    std::vector<bus::Received<T>> never;
    for (auto const& received : inbound.reader->take()) {
        (received.origin.time > end_ ? never : waiting).push_back(received);
    }
    std::stable_sort(waiting.begin(), waiting.end(),
                     [](auto const& a, auto const& b) { return a.origin.time < b.origin.time; });
    waiting.resize(std::min(waiting.size(), kMaxWaiting));
    auto const later =
        std::find_if(waiting.begin(), waiting.end(), [&](auto const& r) { return r.origin.time > until; });
    std::for_each(waiting.begin(), later, tell);
    std::for_each(never.begin(), never.end(), tell); // refused, with a word about it
    waiting.erase(waiting.begin(), later);
}

void ControlGateway::take_commands(Simulation& simulation, SimTime until) {
    if (set_points_ != nullptr) {
        pass_on(*set_points_, simulation, until, [&](Controls::Asked const& asked, SetPoint const& sample) {
            controls_.set_point(simulation, asked, sample.quantity().c_str(), sample.value());
        });
    }
    if (commands_ != nullptr) {
        pass_on(*commands_, simulation, until, [&](Controls::Asked const& asked, ElementCommand const& sample) {
            controls_.command(simulation, asked, static_cast<std::size_t>(sample.command()), sample.mode().c_str());
        });
    }
    controls_.advance(simulation, until);
}

} // namespace gridspace::sim
