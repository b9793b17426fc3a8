// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/grid_model.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "sim/network/network_config.hpp"
#include "sim/solvers/make_engine.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {
namespace {

constexpr char const* kExportAgain = "export the network again";
/// Times come as double, and importers may add them up: in shares of a step of the engine.
constexpr double kRoundingOfStep = 1e-6, kRoundingOfTime = 1e-2;
constexpr double kMostSteps = 1e15;

void observe_nothing(SimTime) {}

double start_of(GridInput const& input) {
    return input.is_command ? (input.on_at_start ? 1 : 0) : input.start;
}

} // namespace

Result<std::unique_ptr<GridModel>> GridModel::load(std::filesystem::path const& resources) {
    config::Diagnostics diagnostics;
    FmuSettings settings;
    auto const root = config::load_yaml(resources / FmuSettings::kFile, diagnostics);
    if (root) {
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, settings); });
    }
    auto network = diagnostics.ok() ? load_network(settings.network, diagnostics) : std::nullopt;
    if (!network) {
        return fail(ExitCode::usage, diagnostics.render(), kExportAgain);
    }
    std::unique_ptr<GridModel> out{new GridModel{std::move(settings), std::move(*network)}};
    if (auto ok = out->find_inputs(); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = out->find_outputs(); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

GridModel::GridModel(FmuSettings settings, Network network)
    : settings_{std::move(settings)}, network_{std::move(network)}, base_{settings_.engine.step_s} {}

Result<void> GridModel::find_inputs() {
    std::vector<GridInput> const all = grid_inputs(network_, settings_.engine.waveform());
    for (std::string const& name : settings_.inputs) {
        auto const found = std::find_if(all.begin(), all.end(), [&](GridInput const& i) { return i.name == name; });
        if (found == all.end()) {
            return fail(ExitCode::usage, fmt::format("the network has no input '{}'", name), kExportAgain);
        }
        inputs_.push_back(*found);
        values_.push_back(start_of(*found));
    }
    in_effect_ = values_;
    return {};
}

Result<void> GridModel::find_outputs() {
    auto const engine = make_engine(settings_.engine, network_, base_);
    if (!engine) {
        return std::unexpected{engine.error()};
    }
    for (std::string const& name : settings_.outputs) {
        std::size_t const signal = (*engine)->find_signal(name);
        if (signal == (*engine)->signals().size()) {
            return fail(ExitCode::usage, fmt::format("the network has no signal '{}'", name), kExportAgain);
        }
        outputs_.push_back(signal);
    }
    return {};
}

GridInput const* GridModel::input(Reference reference) const {
    return reference == kTime || reference > inputs_.size() ? nullptr : &inputs_[reference - 1];
}

bool GridModel::is_command(Reference reference) const {
    GridInput const* found = input(reference);
    return found != nullptr && found->is_command;
}

bool GridModel::is_mode(Reference reference) const {
    GridInput const* found = input(reference);
    return found != nullptr && !found->modes.empty();
}

bool GridModel::is_number(Reference reference) const {
    return reference <= inputs_.size() + outputs_.size() && !is_command(reference) && !is_mode(reference);
}

Result<void> GridModel::start() {
    auto engine = make_engine(settings_.engine, network_, base_);
    if (!engine) {
        return std::unexpected{engine.error()};
    }
    (*engine)->will_read(outputs_);
    auto run = std::make_unique<Simulation>(std::move(*engine), Simulation::Options{base_, SimSpan{1}},
                                            std::vector<TimedAction>{});
    auto ok = run->start(observe_nothing);
    if (ok) {
        run_ = std::move(run);
    }
    return ok;
}

void GridModel::reset() {
    run_.reset();
    std::transform(inputs_.begin(), inputs_.end(), values_.begin(), start_of);
    in_effect_ = values_;
}

Result<void> GridModel::set(Reference reference, double value) {
    GridInput const* changed = input(reference);
    if (changed == nullptr) {
        return fail(ExitCode::usage, fmt::format("value reference {} is no input", reference));
    }
    auto const modes = static_cast<double>(changed->modes.size());
    if (modes > 0 && !(value >= 1 && value <= modes && value == std::floor(value))) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be {}", changed->name, shortest(value)),
                    fmt::format("its modes are 1 to {}: {}", modes, join(changed->modes, ", ")));
    }
    if (!changed->is_command && !within(changed->range, value)) {
        std::string const range = range_text(changed->range);
        return fail(ExitCode::usage, fmt::format("'{}' cannot be {}", changed->name, shortest(value)),
                    range.empty() ? "expected a finite number" : "expected " + range);
    }
    values_[reference - 1] = value;
    return {};
}

Result<double> GridModel::get(Reference reference) const {
    if (reference == kTime) {
        return time_s();
    }
    if (reference <= inputs_.size()) {
        return values_[reference - 1];
    }
    std::size_t const at = reference - inputs_.size() - 1;
    if (at >= outputs_.size()) {
        return fail(ExitCode::usage, fmt::format("there is no variable with value reference {}", reference));
    }
    if (!run_) {
        return fail(ExitCode::usage, fmt::format("'{}' is not known before the initialization", settings_.outputs[at]));
    }
    return run_->engine().value(outputs_[at]);
}

double GridModel::time_s() const {
    return run_ ? base_.seconds(run_->now()) : 0;
}

Result<void> GridModel::step(double from_s, double step_s) {
    double const quantum_s = settings_.engine.step_s.to_double();
    double const count = std::round(step_s / quantum_s);
    if (!(std::abs(from_s - time_s()) <= kRoundingOfTime * quantum_s)) {
        return fail(ExitCode::usage, fmt::format("a step from {} s was asked for, and it is {} s", from_s, time_s()),
                    "steps follow each other from 0 s on; there is no way back");
    }
    if (!(count >= 1 && count <= kMostSteps && std::abs(step_s - count * quantum_s) <= kRoundingOfStep * quantum_s)) {
        return fail(ExitCode::usage,
                    fmt::format("the communication step of {} s from {} s on is no whole number of steps of {} s",
                                step_s, from_s, settings_.engine.step_s.to_string()),
                    "the description gives the step of the engine as fixedInternalStepSize");
    }
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        if (values_[i] != in_effect_[i]) {
            run_->request(run_->now(), inputs_[i].action(values_[i]), inputs_[i].name);
            in_effect_[i] = values_[i];
        }
    }
    Result<void> refused;
    run_->on_refusal([&](SimTime, std::string const& what, Error const& error) {
        refused = fail(error.code, fmt::format("{}: {}", what, error.message), error.remedy);
    });
    auto done = run_->run_until(run_->now() + SimSpan{static_cast<std::int64_t>(count)}, observe_nothing);
    if (!done && done.error().remedy.empty() && !run_->last_request().empty()) {
        done.error().remedy = "the last input that changed was " + run_->last_request();
    }
    return refused ? done : refused;
}

} // namespace gridspace::sim
