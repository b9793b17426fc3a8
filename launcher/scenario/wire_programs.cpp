// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/wire_programs.hpp"

#include "agents/relay/relay_program.hpp"
#include "common/text.hpp"
#include "gateways/breaker/breaker_config.hpp"
#include "gateways/first_line/first_line.hpp"
#include "gateways/mu/mu_config.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/wire_config.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/scenario/healthy_current.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/gateway/gateway_config.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using streams::Kind;
using streams::Stream;

/// The scenario's stream of this name and kind, with an error at `ref` when there is none.
Stream const* must_be_stream(Scenario const& s, Ref const& ref, Kind kind, Diagnostics& diagnostics) {
    return gateways::stream_of(s.streams, ref, kind, diagnostics);
}

/// The members of the data set must exist, and be numbers or a Boolean.
void must_have_member(Stream const* stream, std::string const& member, Ref const& at, bool boolean,
                      Diagnostics& diagnostics) {
    if (stream == nullptr) {
        return;
    }
    std::vector<std::string> names;
    for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream->data_set)) {
        bool const suits = boolean ? leaf.type == iec61850::BasicType::boolean : iec61850::is_number(leaf.type);
        if (leaf.name == member && suits) {
            return;
        }
        if (leaf.name == member) {
            diagnostics.error(at.where,
                              fmt::format("member '{}' of stream '{}' is of type {}", member, stream->name.name,
                                          iec61850::type_name(leaf.type)),
                              boolean ? "expected boolean" : "expected a number", static_cast<int>(at.name.size()));
            return;
        }
        names.push_back(leaf.name);
    }
    diagnostics.error(at.where, fmt::format("stream '{}' has no member '{}'", stream->name.name, member),
                      spelling_hint(member, names), static_cast<int>(at.name.size()));
}

WireUse use_of(Scenario const& s, Process const& process, Ref const& stream) {
    Stream const* found = streams::find_stream(s.streams, stream.name);
    return {raw_link(s, process), found == nullptr ? std::uint16_t{0} : found->ethertype(), stream.name};
}

/// What the events do to the clock of a merging unit, in their order.
Node clock_changes(Scenario const& s, Process const& process) {
    std::vector<sim::Event const*> events;
    for (sim::Event const& event : s.events) {
        if (event.at_s && (event.desynchronise == process.name || event.resynchronise == process.name)) {
            events.push_back(&event);
        }
    }
    std::stable_sort(events.begin(), events.end(), [](auto const* a, auto const* b) { return *a->at_s < *b->at_s; });
    Node list = Node::sequence();
    for (sim::Event const* event : events) {
        Node node = Node::map();
        bool const synchronised = event->resynchronise == process.name;
        node.set("at_s", Node::scalar(event->at_s->to_string()));
        node.set("synchronised", Node::scalar(synchronised ? "true" : "false"));
        node.set("shift_samples", Node::scalar(std::to_string(synchronised ? 0 : event->shift_samples)));
        list.items.push_back(std::move(node));
    }
    return list;
}

class MergingUnitSettings final : public ProcessSettings {
  public:
    explicit MergingUnitSettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        Stream const* stream = must_be_stream(s, config_.to, Kind::smv, diagnostics);
        for (std::string const& member : config_.channels) {
            must_have_member(stream, member, config_.to, false, diagnostics);
        }
        auto const sampled = sim::read_sampling(s.simulation.sampling, diagnostics).rate_hz;
        if (stream != nullptr && stream->rate_hz != sampled) {
            diagnostics.error(config_.to.where,
                              fmt::format("process '{}' sends '{}' at {} Hz, and the simulator samples at {} Hz",
                                          process.name.name, config_.to.name, stream->rate_hz.to_string(),
                                          sampled.to_string()),
                              "make rate_hz of the stream and of simulation.sampling the same",
                              static_cast<int>(config_.to.name.size()));
        }
    }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        add_signals(out);
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override {
        return {{config_.from.name, "LineCurrents", 1, true}};
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.to)};
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const&, Process const& process) const override {
        std::string const prefix = "publisher." + process.name.name + ".";
        std::vector<SignalUse> out{{prefix + "sent", "", 1}, {prefix + "late", "", 1}, {prefix + "underruns", "", 1}};
        for (char const* name : {"publish_age_ms", "wire_delay_ms"}) {
            out.push_back({"stream." + config_.to.name + "." + name, "ms", 0});
        }
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = wire_process_settings(s, process, {config_.to.name});
        node.set("clock_changes", clock_changes(s, process));
        return node;
    }
    [[nodiscard]] gateways::MuConfig const& config() const { return config_; }

  private:
    gateways::MuConfig config_;
};

class BreakerSettings final : public ProcessSettings {
  public:
    explicit BreakerSettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        must_have_member(must_be_stream(s, config_.stream(), Kind::goose, diagnostics), config_.field(), config_.from,
                         true, diagnostics);
    }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out{{config_.to.name, "TripCommand"}};
        add_signals(out);
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.stream())};
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::string const prefix = "breaker_ied." + process.name.name + ".";
        std::vector<SignalUse> out{{prefix + "command", "", 0},
                                   {prefix + "stream_alive", "", 0},
                                   {prefix + "commanded_after_ms", "ms", 0},
                                   {prefix + "effect_ms", "ms", 0}};
        add_first_line_signals(s, process, config_.first_line, {{config_.stream().name, false}}, out);
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        return wire_process_settings(s, process, {config_.stream().name});
    }

  private:
    gateways::BreakerConfig config_;
};

class RelaySettings final : public ProcessSettings {
  public:
    explicit RelaySettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
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
        if (s.network && process.node.find("frequency_hz") == nullptr) {
            config_.frequency_hz = s.network->frequency_hz;
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
        sim::Ct const *const from_ct = transformer(s, config_.from_stream), *const to_ct =
                                                                                transformer(s, config_.to_stream);
        if (process.node.find("positive") == nullptr) {
            config_.from_positive = from_ct == nullptr ? config_.from_positive : polarity(*from_ct);
            config_.to_positive = to_ct == nullptr ? config_.to_positive : polarity(*to_ct);
        }
        if (element && config_.logic.in_service && from_ct != nullptr && to_ct != nullptr) {
            check_healthy_current(s, process, config_, *from_ct, *to_ct, *element, diagnostics);
        }
    }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        add_signals(out);
        if (config_.ids && !config_.ids->verdicts.empty()) {
            out.push_back({config_.ids->verdicts, "IdsVerdict"});
        }
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.trip)};
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.from_stream), use_of(s, process, config_.to_stream)};
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::string const prefix = "relay." + process.name.name + ".";
        std::vector<SignalUse> out;
        for (char const* name : {"pickup", "trip", "blocked"}) {
            out.push_back({prefix + name, "", 0});
        }
        out.push_back({prefix + "sample_s", "s", 0});
        for (Ref const* stream : {&config_.from_stream, &config_.to_stream}) {
            for (char const* name : {"received", "lost", "duplicate", "late", "invalid", "silences"}) {
                out.push_back({"stream." + stream->name + "." + name, "", 1});
            }
            out.push_back({"stream." + stream->name + ".rate_hz", "Hz", 1});
            out.push_back({"stream." + stream->name + ".arrival_age_ms", "ms", 0});
        }
        out.push_back({prefix + "sample_to_decision_ms", "ms", 0});
        for (char const* name : {"st_num", "sq_num"}) {
            out.push_back({"stream." + config_.trip.name + "." + name, "", 0});
        }
        out.push_back({"stream." + config_.trip.name + ".interval_ms", "ms", 0});
        out.push_back({"stream." + config_.trip.name + ".wire_delay_ms", "ms", 0});
        add_first_line_signals(s, process, config_.first_line,
                               {{config_.from_stream.name, true}, {config_.to_stream.name, true}}, out);
        if (config_.ids) {
            add_detector_signals("ids." + process.name.name + ".", out);
        }
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node =
            wire_process_settings(s, process, {config_.from_stream.name, config_.to_stream.name, config_.trip.name});
        node.set("frequency_hz", Node::scalar(shortest(config_.frequency_hz)));
        Node positive = Node::map();
        auto const word = [](relay::Positive p) { return p == relay::Positive::from_to ? "from_to" : "into_line"; };
        positive.set("from", Node::scalar(word(config_.from_positive)));
        positive.set("to", Node::scalar(word(config_.to_positive)));
        node.set("positive", std::move(positive));
        if (Node* detector = node.find("ids"); detector != nullptr && config_.ids) {
            detector->set("model",
                          Node::quoted_text(std::filesystem::absolute(config_.ids->model).lexically_normal().string()));
        }
        return node;
    }

  private:
    [[nodiscard]] Rational frequency() const {
        return Rational::parse(shortest(config_.frequency_hz)).value_or(Rational{60});
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

    void add_detector_signals(std::string const& prefix, std::vector<SignalUse>& out) const {
        for (char const* name : {"alarm", "alarm_reasons", "granted"}) {
            out.push_back({prefix + name, "", 0});
        }
        out.push_back({prefix + "alarms", "", 1});
        for (Ref const* stream : {&config_.from_stream, &config_.to_stream}) {
            std::string const own = prefix + stream->name + ".";
            out.push_back({own + "locked_out", "", 0});
            for (char const* name : relay::kIdsCounters) {
                out.push_back({own + name, "", 1});
            }
            out.push_back({own + "sigma_percent", "%", 1});
            if (!config_.ids->verdicts.empty()) { // of the report's score
                out.push_back({own + "false_positive_percent", "%", 0});
                out.push_back({own + "open_loop_false_positive_percent", "%", 0});
            }
        }
        if (!config_.ids->verdicts.empty()) {
            for (char const* name :
                 {"false_trips", "false_trips_without", "real_faults", "real_faults_tripped", "false_alarms"}) {
                out.push_back({prefix + name, "", 0});
            }
            out.push_back({prefix + "real_fault_trip_added_ms", "ms", 0});
        }
        for (char const* name : {"time_us_p50", "time_us_p99", "time_us_max"}) {
            out.push_back({prefix + name, "us", 0});
        }
    }

    static relay::Positive polarity(sim::Ct const& ct) {
        return ct.positive == sim::CtPolarity::from_to ? relay::Positive::from_to : relay::Positive::into_line;
    }

    /// The transformer behind a stream: stream <- merging unit <- topic <- transformer. Null when the stream comes from
    /// somebody else's device.
    static sim::Ct const* transformer(Scenario const& s, Ref const& stream) {
        Diagnostics ignored; // reported elsewhere
        auto const gateways = sim::read_gateways(s.simulation.gateways, ignored);
        for (Process const& process : s.processes) {
            auto const* unit = dynamic_cast<MergingUnitSettings const*>(process.settings.get());
            if (unit == nullptr || unit->config().to != stream || !s.network) {
                continue;
            }
            for (sim::LineGatewayConfig const& gateway : gateways.lines) {
                for (auto const& publish : gateway.publish) {
                    if (publish.topic != unit->config().from) {
                        continue;
                    }
                    if (sim::Ct const* ct = sim::find(s.network->cts, publish.transformer.name)) {
                        return ct;
                    }
                }
            }
        }
        return nullptr;
    }

    relay::RelayConfig config_;
};

} // namespace

void add_first_line_signals(Scenario const& s, Process const& process, gateways::FirstLineConfig const& config,
                            std::vector<std::pair<std::string, bool>> const& streams, std::vector<SignalUse>& out) {
    if (config.on_finding == gateways::FirstLineConfig::OnFinding::ignore || streams.empty()) {
        return;
    }
    std::string const prefix = "first_line." + process.name.name + ".";
    out.push_back({prefix + "alarm", "", 0});
    for (auto const& [stream, sampled_values] : streams) {
        for (std::string const& name : gateways::first_line_counters(sampled_values)) {
            out.push_back({prefix + stream + "." + name, "", 1});
        }
        Stream const* const declared = streams::find_stream(s.streams, stream);
        if (declared != nullptr && declared->authentication) {
            for (std::string const& name : gateways::authenticity_counters()) {
                out.push_back({prefix + stream + "." + name, "", 1});
            }
        }
    }
}

void add_signals(std::vector<TopicUse>& topics) {
    topics.push_back({"signals", "SignalFrame"});
    topics.push_back({"signal_catalog", "SignalCatalog"});
}

Node wire_process_settings(Scenario const& s, Process const& process, std::vector<std::string> const& used) {
    Node node = own_settings(process);
    node.set("wire", wire_settings(s, process));
    Node declared = Node::map();
    Node const* all = s.resolved.find("streams");
    for (std::string const& name : used) {
        if (Node const* stream = all == nullptr ? nullptr : all->find(name)) {
            declared.set(name, *stream);
            Stream const* const read = streams::find_stream(s.streams, name);
            if (read != nullptr && read->authentication && !read->authentication->key_file.empty()) {
                auto const file = std::filesystem::absolute(read->authentication->key_file).lexically_normal();
                declared.find(name)->find("authentication")->set("key_file", Node::quoted_text(file.string()));
            }
        }
    }
    node.set("streams", std::move(declared));
    return node;
}

std::unique_ptr<ProcessSettings> read_merging_unit(Fields& f) {
    return std::make_unique<MergingUnitSettings>(f);
}
std::unique_ptr<ProcessSettings> read_breaker(Fields& f) {
    return std::make_unique<BreakerSettings>(f);
}
std::unique_ptr<ProcessSettings> read_relay(Fields& f) {
    return std::make_unique<RelaySettings>(f);
}

} // namespace gridspace::launcher
