// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-fmu, as the launcher sees it: its settings checked against what the FMU says of itself. Nothing of it is
// run.
#include "agents/fmu/fmu_table.hpp"
#include "bus/topics.hpp"
#include "fmi/archive.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using agents::FmuConfig;
using config::Diagnostics;
using config::Node;

class FmuSettings final : public ProcessSettings {
  public:
    explicit FmuSettings(config::Fields& f) { describe(f, config_); }

    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        Rational const step_s = s.simulation.step_s;
        if (step_s > Rational{0} && config_.period_s > Rational{0} && !(config_.period_s / step_s).is_whole()) {
            Node const* written = process.node.find("period_s");
            diagnostics.error(written == nullptr ? process.name.where : written->where,
                              fmt::format("'period_s' of {} s is not a whole number of steps of {} s",
                                          config_.period_s.to_string(), step_s.to_string()));
        }
        auto const complain = [&](Error const& error) {
            diagnostics.error(config_.fmu_at, error.message, error.remedy);
        };
        if (config_.fmu.empty()) {
            return; // said already
        }
        auto const archive = fmi::Archive::open(config_.fmu);
        if (!archive) {
            return complain(archive.error());
        }
        auto description = fmi::read_model_description(*archive, config_.fmu.filename().string());
        if (!description) {
            return complain(description.error());
        }
        if (auto const binary = fmi::binary_of(*archive, *description); !binary) {
            return complain(binary.error());
        }
        description_ = std::move(*description);
        table_ = agents::make_table(config_, description_, process.name.name, bus::idl_of_type, diagnostics);
    }

    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        for (agents::FmuOutput const& output : config_.outputs) {
            bool const steers = !output.set_point.empty();
            std::string const topic = steers ? "set_points" : output.to.topic.name;
            if (std::none_of(out.begin(), out.end(), [&](TopicUse const& use) { return use.topic == topic; })) {
                out.push_back({topic, steers ? "SetPoint" : output.to.type.name, 1, false, true});
            }
        }
        if (!config_.watch.empty()) {
            add_signals(out);
        }
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        for (agents::FmuInput const& input : config_.inputs) {
            if (std::none_of(out.begin(), out.end(),
                             [&](TopicUse const& use) { return use.topic == input.from.topic.name; })) {
                out.push_back({input.from.topic.name, input.from.type.name});
            }
        }
        return out;
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const&, Process const& process) const override {
        std::vector<SignalUse> out;
        for (std::size_t const at : table_.watched) {
            fmi::Variable const& variable = description_.variables[at];
            out.push_back({agents::signal_name(process.name.name, variable.name), variable.unit.substr(0, 16),
                           1 / config_.period_s.to_double()});
        }
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const&, Process const& process) const override {
        Node node = own_settings(process);
        node.set("fmu", Node::quoted_text(std::filesystem::absolute(config_.fmu).lexically_normal().string()));
        return node;
    }

  private:
    FmuConfig config_;
    fmi::ModelDescription description_; ///< after check()
    agents::FmuTable table_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_fmu(config::Fields& f) {
    return std::make_unique<FmuSettings>(f);
}

} // namespace gridspace::launcher
