// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/function_config.hpp"
#include "agents/relay/relay_declaration.hpp"
#include "common/text.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/healthy_current.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using streams::Kind;
using streams::Stream;

class RelaySettings final : public DeclaredSettings {
  public:
    explicit RelaySettings(Fields& f) : DeclaredSettings{relay::relay_declaration()} { describe(f, config_); }
    void settle(Scenario const& s, Process const&) override { declare(relay::declaration(config_, context_of(s))); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        if (s.network && process.node.find("frequency_hz") == nullptr) {
            config_.frequency_hz = s.network->frequency_hz;
        }
        if (config_.is_of_bay()) {
            check_bay(s, process, diagnostics);
            return;
        }
        Stream const* from = must_be_stream(s, config_.from_stream, Kind::smv, diagnostics);
        Stream const* to = must_be_stream(s, config_.to_stream, Kind::smv, diagnostics);
        for (std::string const& member : config_.channels) {
            must_have_member(from, member, config_.from_stream, false, diagnostics);
            must_have_member(to, member, config_.to_stream, false, diagnostics);
        }
        must_have_member(must_be_stream(s, config_.trip, Kind::goose, diagnostics), config_.trip_field, config_.trip,
                         true, diagnostics);
        if (from != nullptr && to != nullptr && from->rate_hz != to->rate_hz) {
            diagnostics.error(config_.to_stream.where,
                              fmt::format("streams '{}' and '{}' have different rates", from->name.name, to->name.name),
                              "a differential relay compares samples of one instant");
        }
        for (auto const& [stream, ref] : {std::pair{from, &config_.from_stream}, std::pair{to, &config_.to_stream}}) {
            warn_of_long_frames(stream, *ref, diagnostics);
        }
        std::optional<relay::ElementParams> element;
        // A network that cannot be read has been complained about; its frequency is not known.
        bool const frequency_known =
            s.network || s.simulation.network.empty() || process.node.find("frequency_hz") != nullptr;
        if (from != nullptr && frequency_known) {
            if (auto const params = relay::make_params(config_.logic, from->rate_hz, frequency())) {
                element = params->element;
            } else {
                diagnostics.error(process.name.where, params.error().message, params.error().remedy,
                                  static_cast<int>(process.name.name.size()));
            }
        }
        check_detector(process, from, diagnostics);
        sim::Ct const *const from_ct = transformer_behind(s, config_.from_stream), *const to_ct = transformer_behind(
                                                                                       s, config_.to_stream);
        if (process.node.find("positive") == nullptr) {
            config_.from_positive = from_ct == nullptr ? config_.from_positive : polarity(*from_ct);
            config_.to_positive = to_ct == nullptr ? config_.to_positive : polarity(*to_ct);
        }
        if (element && config_.logic.in_service && from_ct != nullptr && to_ct != nullptr) {
            check_healthy_current(s, process, config_, *from_ct, *to_ct, *element, diagnostics);
        }
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = DeclaredSettings::settings(s, process);
        node.set("frequency_hz", Node::scalar(shortest(config_.frequency_hz)));
        if (config_.is_of_bay()) {
            if (Node* inputs = node.find("inputs")) {
                inputs->set("reversed", Node::scalar(config_.bay.reversed ? "true" : "false"));
            }
            return node;
        }
        Node positive = Node::map();
        auto const word = [](relay::Positive p) { return p == relay::Positive::from_to ? "from_to" : "into_line"; };
        positive.set("from", Node::scalar(word(config_.from_positive)));
        positive.set("to", Node::scalar(word(config_.to_positive)));
        node.set("positive", std::move(positive));
        return node;
    }

  private:
    [[nodiscard]] Rational frequency() const {
        return Rational::parse(shortest(config_.frequency_hz)).value_or(Rational{60});
    }

    /// A bay: its streams, its functions, and what they say in the trip stream.
    void check_bay(Scenario const& s, Process const& process, Diagnostics& diagnostics) {
        relay::BayConfig& bay = config_.bay;
        Stream const* first = nullptr;
        auto const must_have = [&](Ref const& ref, std::array<std::string, 3> const& members) {
            Stream const* const stream = ref.empty() ? nullptr : must_be_stream(s, ref, Kind::smv, diagnostics);
            for (std::string const& member : members) {
                must_have_member(stream, member, ref, false, diagnostics);
            }
            if (first != nullptr && stream != nullptr && first->rate_hz != stream->rate_hz) {
                diagnostics.error(ref.where,
                                  fmt::format("streams '{}' and '{}' have different rates", first->name.name, ref.name),
                                  "a relay compares samples of one instant");
            }
            first = first == nullptr ? stream : first;
        };
        must_have(bay.currents, bay.current_members);
        must_have(bay.voltages, bay.voltage_members);
        must_have(bay.bus_voltages, bay.voltage_members);
        if (config_.inputs().size() > 2 || (!bay.bus_voltages.empty() && bay.bus_voltages == bay.voltages)) {
            diagnostics.error(bay.bus_voltages.where,
                              "a relay hears at most two streams, each with at most one set of voltages",
                              "currents and voltages of a bay come in one stream (9-2LE), those of the bus in another",
                              static_cast<int>(bay.bus_voltages.name.size()));
        }
        Stream const* const trip = must_be_stream(s, config_.trip, Kind::goose, diagnostics);
        must_have_member(trip, config_.trip_field, config_.trip, true, diagnostics);
        if (Node const* inputs = process.node.find("inputs");
            inputs == nullptr || inputs->find("reversed") == nullptr) {
            sim::Ct const* const ct = transformer_behind(s, bay.currents);
            bay.reversed = ct != nullptr && ct->end == sim::LineEnd::to && ct->positive == sim::CtPolarity::from_to;
        }
        if (first != nullptr) {
            check_functions(process, *first, trip, diagnostics);
        }
    }

    void check_functions(Process const& process, Stream const& stream, Stream const* trip, Diagnostics& diagnostics) {
        auto const params = relay::make_bay_params(config_, stream.rate_hz);
        if (!params) {
            diagnostics.error(process.name.where, params.error().message, params.error().remedy,
                              static_cast<int>(process.name.name.size()));
            return;
        }
        auto const set = relay::make_functions(
            config_.bay.functions, {params->rate_hz, params->frequency_hz, params->samples_per_cycle, params->inputs},
            diagnostics);
        for (auto const& [member, what] : config_.bay.outputs) {
            must_have_member(trip, member, Ref{member, what.where}, true, diagnostics);
            if (set && !relay::find_output(*set, what.name)) {
                diagnostics.error(what.where, fmt::format("'{}' is no output of a function", what.name),
                                  "NAME.op or NAME.str of one of `functions`", static_cast<int>(what.name.size()));
            }
        }
    }

    void warn_of_long_frames(Stream const* stream, Ref const& ref, Diagnostics& diagnostics) const {
        std::int64_t const bridged = config_.logic.max_interpolated;
        if (stream != nullptr && stream->samples_per_frame > bridged) {
            diagnostics.warning(
                ref.where,
                fmt::format("one lost frame of stream '{}' blocks the relay for a whole window: {} samples, and "
                            "`max_interpolated` is {}",
                            ref.name, stream->samples_per_frame, bridged),
                stream->samples_per_frame <= 8
                    ? fmt::format("`blocking: {{max_interpolated: {}}}` bridges it", stream->samples_per_frame)
                    : "send fewer samples in a frame (`samples_per_frame`)",
                static_cast<int>(ref.name.size()));
        }
    }

    /// The model must be there, undamaged, and made for the streams.
    void check_detector(Process const& process, Stream const* stream, Diagnostics& diagnostics) const {
        if (!config_.ids || config_.ids->model.empty()) {
            return;
        }
        using Of = ids::ThresholdParams::Of;
        Node const* section = process.node.find("ids");
        Node const* written = section == nullptr ? nullptr : section->find("model");
        auto const where = written == nullptr ? process.name.where : written->where;
        auto const complain = [&](Error const& error) {
            diagnostics.error(where, error.message, error.remedy,
                              written == nullptr ? 1 : static_cast<int>(written->text.size()));
        };
        auto const model = ids::load_model(config_.ids->model);
        if (!model) {
            complain(model.error());
        } else if (stream != nullptr && (config_.ids->nominal_peak_a > 0 || config_.ids->of == Of::instantaneous ||
                                         config_.ids->of == Of::running_peak)) {
            if (auto const params =
                    ids::make_detector_params(*config_.ids, *model, stream->rate_hz.to_double(), config_.frequency_hz);
                !params) {
                complain(params.error());
            }
        }
    }

    static relay::Positive polarity(sim::Ct const& ct) {
        return ct.positive == sim::CtPolarity::from_to ? relay::Positive::from_to : relay::Positive::into_line;
    }

    relay::RelayConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_relay(Fields& f) {
    return std::make_unique<RelaySettings>(f);
}

} // namespace gridspace::launcher
