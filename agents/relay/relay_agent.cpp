// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-relay: line differential protection; two streams of sampled values in, a trip by GOOSE out.
#include "agents/relay/current_inputs.hpp"
#include "agents/relay/event_report.hpp"
#include "agents/relay/guarded_relay.hpp"
#include "agents/relay/intrusion_output.hpp"
#include "agents/relay/relay_program.hpp"
#include "agents/relay/trip_publisher.hpp"
#include "bus/daemon.hpp"
#include "bus/tick_grid.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "gateways/port/first_line_report.hpp"
#include "gateways/port/statistics.hpp"
#include "ids/forecaster/model_file.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::relay {
namespace {

using gateways::WireClock;
using gateways::WirePort;

struct Settings {
    RelayConfig relay;
    gateways::WireConfig wire;
};

class RelayAgent {
  public:
    RelayAgent(Settings const& settings, DaemonRun& run, bus::Node& node)
        : settings_{settings}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock},
          latency_ns_{clock_.of(SimTime{} + node.time_base().ceil(settings.relay.latency_us / Rational{1'000'000}))} {
        if (!node.lockstep()) {
            latency_ns_ = std::llround(static_cast<double>(latency_ns_) / settings.wire.speed);
        }
    }

    Result<void> run() {
        if (auto ok = prepare(); !ok) {
            return ok;
        }
        if (auto ok = node_.start(); !ok) {
            return ok;
        }
        while (true) {
            auto const next = next_work();
            auto tick = node_.lockstep() ? node_.next()
                                         : node_.next(next ? std::optional{WireClock::wall(*next)} : std::nullopt);
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            if (!*tick) {
                return {};
            }
            begin((*tick)->time);
            if (node_.lockstep()) {
                lockstep_tick((*tick)->time);
            } else {
                follow_clock();
                realtime_round();
            }
            report((*tick)->time, (*tick)->final);
            port_->maintain();
            std::uint64_t needed = (*tick)->number + 1;
            if (auto const work = next_work()) {
                needed = grid_.tick_of(clock_.at_or_after(*work));
            }
            if (auto ok = node_.done(**tick, needed); !ok) {
                return ok;
            }
        }
    }

  private:
    Result<void> prepare() {
        RelayConfig const& config = settings_.relay;
        config::Diagnostics diagnostics;
        auto const find = [&](config::Ref const& name, streams::Kind kind) {
            return gateways::stream_of(settings_.wire.streams, name, kind, diagnostics);
        };
        streams::Stream const* from = find(config.from_stream, streams::Kind::smv);
        streams::Stream const* to = find(config.to_stream, streams::Kind::smv);
        streams::Stream const* trip = find(config.trip, streams::Kind::goose);
        if (from == nullptr || to == nullptr || trip == nullptr) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        auto params = make_params(config.logic, from->rate_hz,
                                  Rational::parse(shortest(config.frequency_hz)).value_or(Rational{60}));
        if (!params) {
            return std::unexpected{params.error()};
        }
        params->from_positive = config.from_positive;
        params->to_positive = config.to_positive;
        rate_hz_ = from->rate_hz.to_double();
        if (auto ok = make_relay(*params, from->rate_hz); !ok) {
            return ok;
        }
        bool const accept_test = config.logic.test_mode;
        auto inputs = CurrentInputs::create(
            *from, *to,
            {config.channels, static_cast<std::int64_t>(config.partner_timeout_ms * 1e6),
             static_cast<int>(config.logic.max_interpolated), config.first_line, accept_test, !node_.lockstep()});
        if (!inputs) {
            return std::unexpected{inputs.error()};
        }
        inputs_ = std::make_unique<CurrentInputs>(std::move(*inputs));
        inputs_->on_silence([this](std::size_t end) { act_on(relay_->relay().lost(end == 0 ? kFromLost : kToLost)); });
        open_event_report();
        auto port = WirePort::open(node_, settings_.wire, {{trip->ethertype()}, {from->ethertype()}});
        if (!port) {
            return std::unexpected{port.error()};
        }
        port_ = std::move(*port);
        auto publisher = TripPublisher::create(node_, *port_, *trip, config.trip_field);
        if (!publisher) {
            return std::unexpected{publisher.error()};
        }
        trip_ = std::move(*publisher);
        auto statistics = gateways::StatisticsPublisher::create(node_);
        if (!statistics) {
            return std::unexpected{statistics.error()};
        }
        statistics_ = std::move(*statistics);
        stream_rows_ = {&statistics_->add(from->name.name, STREAM_RECEIVED),
                        &statistics_->add(to->name.name, STREAM_RECEIVED),
                        &statistics_->add(trip->name.name, STREAM_SENT)};
        if (auto ok = open_first_line(); !ok) {
            return ok;
        }
        return open_signals();
    }

    Result<void> open_first_line() {
        if (settings_.relay.first_line.on_finding == gateways::FirstLineConfig::OnFinding::ignore) {
            return {};
        }
        std::vector<gateways::FirstLineReport::Stream> streams;
        std::array<config::Ref const*, 2> const names{&settings_.relay.from_stream, &settings_.relay.to_stream};
        for (std::size_t i = 0; i < 2; ++i) {
            gateways::SvFirstLine const& rules = inputs_->end(i).first_line;
            streams.push_back({names[i]->name, streams::Kind::smv, [&rules] { return rules.counters(); },
                               [&rules] { return rules.refused(); }, [&rules] { return rules.contested(); }});
        }
        auto report = gateways::FirstLineReport::create(node_, run_, std::move(streams));
        if (!report) {
            return std::unexpected{report.error()};
        }
        first_line_ = std::move(*report);
        inputs_->on_finding([this](std::size_t end, std::uint32_t findings, iec61850::Mac const& source) {
            first_line_->finding(end, findings, source, now());
        });
        return {};
    }

    /// Into the folder of the run; a relay without a run, on a board of its own, needs to be told where.
    void open_event_report() {
        EventReportConfig config = settings_.relay.event_report;
        char const* run = std::getenv("GRIDSPACE_RUN_FOLDER");
        if (config.folder.empty() && run != nullptr) {
            config.folder = std::filesystem::path{run} / "event_reports";
        }
        if (config.trigger != EventReportConfig::Trigger::off && !config.folder.empty()) {
            event_report_ = std::make_unique<EventReport>(
                config, EventReportFacts{node_.config().process, settings_.relay.from_stream.name,
                                         settings_.relay.to_stream.name, rate_hz_, settings_.relay.frequency_hz});
        }
    }

    Result<void> make_relay(RelayParams const& params, Rational rate_hz) {
        if (!settings_.relay.ids) {
            relay_ = std::make_unique<GuardedRelay>(params);
            return {};
        }
        auto const model = ids::load_model(settings_.relay.ids->model);
        if (!model) {
            return std::unexpected{model.error()};
        }
        auto const detector =
            ids::make_detector_params(*settings_.relay.ids, *model, rate_hz.to_double(), settings_.relay.frequency_hz);
        if (!detector) {
            return std::unexpected{detector.error()};
        }
        relay_ = std::make_unique<GuardedRelay>(params, *model, *detector);
        auto output = IntrusionOutput::create(node_, run_, settings_.relay, rate_hz);
        if (!output) {
            return std::unexpected{output.error()};
        }
        intrusion_ = std::move(*output);
        return {};
    }

    Result<void> open_signals() {
        std::string const prefix = "relay." + node_.config().process + ".";
        auto state = bus::SignalPublisher::create(
            node_, "relay", 0,
            {{prefix + "pickup", ""}, {prefix + "trip", ""}, {prefix + "blocked", ""}, {prefix + "sample_s", "s"}});
        if (!state) {
            return std::unexpected{state.error()};
        }
        state_signals_ = std::move(*state);
        std::vector<bus::SignalColumn> columns;
        for (config::Ref const* stream : {&settings_.relay.from_stream, &settings_.relay.to_stream}) {
            for (char const* name : {"received", "lost", "duplicate", "late", "invalid", "silences"}) {
                columns.push_back({"stream." + stream->name + "." + name, ""});
            }
            if (!node_.lockstep()) { // says nothing where nobody looks at a clock
                columns.push_back({"stream." + stream->name + ".rate_hz", "Hz"});
            }
        }
        auto counters = bus::SignalPublisher::create(node_, "streams", 1, std::move(columns));
        if (!counters) {
            return std::unexpected{counters.error()};
        }
        counter_signals_ = std::move(*counters);
        return node_.lockstep() ? Result<void>{} : open_age_signals();
    }

    /// Real time: how old a sample is when it comes and when it has been decided about; times are those of the samples.
    Result<void> open_age_signals() {
        auto const open = [&](char const* group, std::string name) {
            return bus::SignalPublisher::create(node_, group, rate_hz_, {{std::move(name), "ms"}});
        };
        std::array<config::Ref const*, 2> const streams{&settings_.relay.from_stream, &settings_.relay.to_stream};
        for (std::size_t i = 0; i < 2; ++i) {
            auto arrivals =
                open(i == 0 ? "arrival_from" : "arrival_to", "stream." + streams[i]->name + ".arrival_age_ms");
            if (!arrivals) {
                return std::unexpected{arrivals.error()};
            }
            arrival_ages_[i] = std::move(*arrivals);
        }
        auto decisions = open("decision", "relay." + node_.config().process + ".sample_to_decision_ms");
        if (!decisions) {
            return std::unexpected{decisions.error()};
        }
        decision_ages_ = std::move(*decisions);
        return {};
    }

    [[nodiscard]] std::vector<bus::SignalPublisher*> all_signals() const {
        std::vector<bus::SignalPublisher*> out{state_signals_.get(), counter_signals_.get()};
        for (auto const* ages : {&arrival_ages_[0], &arrival_ages_[1], &decision_ages_}) {
            if (*ages != nullptr) {
                out.push_back(ages->get());
            }
        }
        return out;
    }

    void begin(SimTime now) {
        if (started_) {
            return;
        }
        started_ = true;
        for (bus::SignalPublisher* signals : all_signals()) {
            signals->announce(now);
        }
        if (intrusion_ != nullptr) {
            intrusion_->announce(now);
        }
        if (first_line_ != nullptr) {
            first_line_->announce(now);
        }
        trip_->announce(now);
        now_ns_ = node_.lockstep() ? clock_.of(now) : clock_.now();
        trip_->start(now_ns_);
        blocked_ = relay_->relay().output().blocked != 0; // also when no sample ever comes
        publish_state();
    }

    [[nodiscard]] std::optional<std::int64_t> next_work() const {
        auto out = trip_->due();
        if (auto const deadline = inputs_->deadline()) {
            out = out ? std::min(*out, *deadline) : *deadline;
        }
        return out;
    }

    /// Does everything that time alone asks for, up to and including `until_ns`, in its order.
    void elapse(std::int64_t until_ns) {
        while (true) {
            auto const deadline = inputs_->deadline();
            auto const due = trip_->due();
            bool const input_first = deadline && (!due || *deadline < *due);
            auto const at = input_first ? deadline : due;
            if (!at || *at > until_ns) {
                return;
            }
            now_ns_ = std::max(now_ns_, node_.lockstep() ? clock_.of(clock_.at_or_after(*at)) : *at);
            if (now_ns_ > until_ns && node_.lockstep()) {
                return; // rounded up to the time grid, behind the end of the tick
            }
            if (input_first) {
                inputs_->elapse(node_.lockstep() ? now_ns_ : *at, on_pair_); // in real time it lives by arrivals
            } else {
                trip_->work(now_ns_);
            }
        }
    }

    void lockstep_tick(SimTime end) {
        // Who was paused finds frames of ticks that are over; what it does about them, it does now.
        now_ns_ = std::max(now_ns_, clock_.of(end - node_.time_base().nearest(node_.config().clock.tick_s)));
        for (bus::WireFrame const* frame : port_->take(iec61850::kSvEthertype)) {
            std::int64_t const at = clock_.of(frame->time);
            elapse(at - 1); // at equal times the frame comes first
            now_ns_ = std::max(now_ns_, at);
            inputs_->frame(WirePort::octets(*frame), now_ns_, on_pair_);
        }
        elapse(clock_.of(end));
    }

    /// It protects by frames alone, with or without a simulation clock; what it publishes needs simulated times. A
    /// relay that is there before the run, or comes back in it, has none at first.
    void follow_clock() {
        if (!known_since_ns_ && node_.clock_runs()) {
            known_since_ns_ = clock_.now();
            came_ns_ = 0; // what came before was put at no time
            publish_state();
        }
    }

    [[nodiscard]] bool time_is_known() const { return node_.lockstep() || known_since_ns_; }

    void realtime_round() {
        take_frames();
        std::int64_t const now_ns = clock_.now();
        if (auto const work = next_work(); work && *work <= now_ns) {
            port_->drain(); // what has come by now counts before what has run out by now
            take_frames();
        }
        elapse(now_ns);
    }

    /// The inputs live by the arrivals of the frames: a stall of this process is no gap in a stream. What follows from
    /// them happens now.
    void take_frames() {
        for (bus::WireFrame const* frame : port_->take(iec61850::kSvEthertype)) {
            now_ns_ = clock_.now();
            came(frame->arrived_ns);
            std::array<std::uint64_t, 2> const before{samples_of(0), samples_of(1)};
            inputs_->elapse(frame->arrived_ns - 1, on_pair_); // at equal times the frame comes first
            inputs_->frame(WirePort::octets(*frame), frame->arrived_ns, on_pair_);
            for (std::size_t i = 0; i < 2; ++i) {
                if (samples_of(i) != before[i] && frame->kernel_ns != 0) {
                    publish_age(*arrival_ages_[i], inputs_->end(i).subscriber.last_index(), frame->kernel_ns);
                }
            }
        }
    }

    /// Real time: the simulated time at which a frame came. Of one that has waited, because this process stood still,
    /// the simulation clock no longer says it: it came so long after the last one that had not.
    void came(std::int64_t arrived_ns) {
        constexpr std::int64_t kAtOnceNs = 100'000'000;
        double const now_s = node_.time_base().seconds(node_.latest_time());
        bool const at_once = came_ns_ == 0 || now_ns_ - arrived_ns < kAtOnceNs;
        came_s_ = at_once ? now_s : came_s_ + static_cast<double>(arrived_ns - came_ns_) * 1e-9 * settings_.wire.speed;
        came_ns_ = arrived_ns;
    }

    /// Simulated time of a sample: its counter says which one of a second it is, the clock which second.
    [[nodiscard]] double instant_of(std::int64_t index) const {
        double const in_second_s = static_cast<double>(index) / rate_hz_;
        double const now_s = came_ns_ == 0 ? node_.time_base().seconds(node_.latest_time()) : came_s_;
        return std::round(now_s - in_second_s) + in_second_s;
    }

    /// When a sample was taken, by its counter: simulated time on the epoch, or in real time on the run's start.
    [[nodiscard]] std::int64_t utc_of(std::int64_t index) const {
        std::int64_t const ns = std::llround(instant_of(index) * 1e9);
        return node_.lockstep() ? clock_.utc_ns(ns) : node_.start_unix_ns() + ns;
    }

    void publish_age(bus::SignalPublisher& ages, std::int64_t index, std::int64_t unix_ns) {
        if (!known_since_ns_ || came_ns_ < *known_since_ns_) {
            return; // which second a counter belongs to was not known when the sample came
        }
        double const time_s = instant_of(index);
        double const age_ms = clock_.age_ms(unix_ns, time_s, settings_.wire.speed);
        ages.row(node_.time_base().from_nanoseconds(std::llround(time_s * 1e9)), {&age_ms, 1});
    }

    [[nodiscard]] std::uint64_t samples_of(std::size_t end) const {
        return inputs_->end(end).subscriber.counters().samples;
    }

    void pair(LineSample const& sample) {
        RelayOutput const& out = intrusion_ == nullptr ? relay_->step(sample) : guarded(sample);
        if (event_report_ != nullptr) {
            event_report_->sample(sample, out, utc_of(sample.index));
        }
        if (decision_ages_ != nullptr && sample.from.present && sample.to.present) {
            publish_age(*decision_ages_, sample.index, clock_.utc_ns(0));
        }
        act_on(out);
    }

    void act_on(RelayOutput const& out) {
        if (out.pickup != pickup_ || out.trip != tripped_ || (out.blocked != 0) != blocked_) {
            bool const changed = out.trip != tripped_;
            pickup_ = out.pickup;
            tripped_ = out.trip;
            blocked_ = out.blocked != 0;
            publish_state();
            if (changed && settings_.relay.trip_output == RelayConfig::TripOutput::enabled) {
                trip_->set(tripped_, now_ns_ + latency_ns_); // in real time at least so late: a hold-back
            }
        }
        publish_events();
    }

    /// Detector and relay, the detector's time taken.
    RelayOutput const& guarded(LineSample const& sample) {
        std::int64_t const before = processor_time_ns();
        relay_->judge(sample);
        std::int64_t const took_ns = processor_time_ns() - before;
        RelayOutput const& out = relay_->decide(sample);
        double const instant_s = instant_of(sample.index);
        intrusion_->sample(*relay_->detector(), std::llround(instant_s * rate_hz_), std::llround(instant_s * 1e9),
                           now(), took_ns);
        return out;
    }

    [[nodiscard]] SimTime now() const { return node_.lockstep() ? clock_.at_or_after(now_ns_) : node_.latest_time(); }

    void publish_state() {
        if (!time_is_known()) {
            return;
        }
        std::array<double, 4> const row{pickup_ ? 1.0 : 0.0, tripped_ ? 1.0 : 0.0, blocked_ ? 1.0 : 0.0,
                                        instant_of(relay_->relay().output().index)};
        state_signals_->row(now(), row);
    }

    /// Also while it stays blocked: another reason is an event of its own.
    void publish_events() {
        relay_->relay().events().drain([&](RelayEvent const& event) {
            std::string text = fmt::format("sample {}", event.index);
            if (event.phases != 0) {
                text += fmt::format(", phases {}, {:.1f} {:.1f} {:.1f} A", phase_names(event.phases),
                                    event.differential_a[0], event.differential_a[1], event.differential_a[2]);
            }
            if (event.reasons != 0) {
                text += ": " + block_names(event.reasons);
            }
            if (event_report_ != nullptr) {
                event_report_->event(
                    fmt::format("{:.6f} s  {}: {}", instant_of(event.index), name_of(event.kind), text));
            }
            log::info("{}: {}", name_of(event.kind), text);
            if (time_is_known()) { // what was before is in the log; it is no event of the run
                run_.status.event(node_.time_base().seconds(now()), node_.config().process, name_of(event.kind), text);
            }
        });
    }

    /// Counters once per simulated second.
    void report(SimTime time, bool final) {
        auto const second = static_cast<std::int64_t>(node_.time_base().seconds(time));
        if ((second == reported_ && !final) || !time_is_known()) {
            return;
        }
        reported_ = second;
        for (std::size_t i = 0; i < 2; ++i) {
            gateways::report_received(*stream_rows_[i], inputs_->end(i).subscriber);
            stream_rows_[i]->refused(stream_rows_[i]->refused() + inputs_->end(i).first_line.refused());
            stream_rows_[i]->dropped(port_->dropped());
        }
        gateways::report_sent(*stream_rows_[2], trip_->counters());
        stream_rows_[2]->dropped(port_->sent_counters().send_failed);
        statistics_->publish(time);
        if (first_line_ != nullptr) {
            first_line_->report(time);
        }
        std::array<double, 14> row{};
        std::size_t const columns = node_.lockstep() ? 6 : 7;
        std::int64_t const wall = clock_.now();
        for (std::size_t i = 0; i < 2; ++i) {
            using iec61850::SvEvent;
            auto const& c = inputs_->end(i).subscriber.counters();
            double* out = row.data() + columns * i;
            out[0] = static_cast<double>(c.samples);
            // What is overtaken may still come: at the end it is lost.
            out[1] = static_cast<double>(final ? c.lost : inputs_->end(i).subscriber.lost_for_good());
            out[2] = static_cast<double>(c.of(SvEvent::duplicate));
            out[3] = static_cast<double>(c.of(SvEvent::late));
            out[4] = static_cast<double>(c.of(SvEvent::identity_mismatch) + c.of(SvEvent::conf_rev_mismatch) +
                                         c.of(SvEvent::size_mismatch) + c.of(SvEvent::simulation_refused) +
                                         inputs_->damaged().total());
            out[5] = static_cast<double>(c.silences);
            if (columns > 6) {
                // Between two reports, by the wall clock; the first one has nothing to compare with.
                double const seconds = static_cast<double>(wall - reported_wall_ns_) / 1e9;
                out[6] = reported_wall_ns_ == 0 ? 0 : static_cast<double>(c.samples - reported_samples_[i]) / seconds;
                reported_samples_[i] = c.samples;
            }
        }
        bool const nothing_to_compare = reported_wall_ns_ == 0;
        reported_wall_ns_ = wall;
        if (columns > 6 && nothing_to_compare) {
            return;
        }
        counter_signals_->row(time, row);
        if (intrusion_ != nullptr) {
            intrusion_->report(*relay_->detector(), time);
            intrusion_->flush(time, final);
        }
        for (bus::SignalPublisher* signals : all_signals()) {
            signals->flush();
        }
    }

    Settings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    WireClock clock_;
    bus::TickGrid grid_;
    std::int64_t latency_ns_;
    std::unique_ptr<GuardedRelay> relay_;
    std::unique_ptr<IntrusionOutput> intrusion_; ///< with a detector
    std::unique_ptr<CurrentInputs> inputs_;
    std::unique_ptr<EventReport> event_report_;
    std::unique_ptr<WirePort> port_;
    std::unique_ptr<TripPublisher> trip_;
    std::unique_ptr<gateways::FirstLineReport> first_line_; ///< unless the rules are off
    std::unique_ptr<gateways::StatisticsPublisher> statistics_;
    std::array<StreamStatistics*, 3> stream_rows_{}; ///< both currents, the trip
    std::unique_ptr<bus::SignalPublisher> state_signals_, counter_signals_;
    std::array<std::unique_ptr<bus::SignalPublisher>, 2> arrival_ages_; ///< real time
    std::unique_ptr<bus::SignalPublisher> decision_ages_;               ///< real time
    double rate_hz_{4800};
    CurrentInputs::OnPair on_pair_{[this](LineSample const& sample) { pair(sample); }};
    std::int64_t now_ns_{0};
    std::int64_t came_ns_{0}; ///< real time: when the newest frame came, and at which simulated time
    double came_s_{0};
    std::optional<std::int64_t> known_since_ns_; ///< real time: since when simulated time is known
    std::int64_t reported_{-1}, reported_wall_ns_{0};
    std::array<std::uint64_t, 2> reported_samples_{};
    bool started_{false}, pickup_{false}, tripped_{false}, blocked_{false};
};

} // namespace
} // namespace gridspace::relay

int main(int argc, char** argv) {
    using namespace gridspace;
    relay::Settings settings;
    Daemon const daemon{"gridspace-relay",
                        "line differential relay: sampled values in, trip by GOOSE out",
                        [&](config::Fields& f) {
                            describe(f, settings.relay);
                            gateways::describe_wire(f, settings.wire);
                        },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                return relay::RelayAgent{settings, run, node}.run();
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}
