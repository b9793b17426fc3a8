// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/line_watch.hpp"

#include <numbers>

namespace gridspace::scan {
namespace {

constexpr double kPickup = 0.3, kSlopePercent = 30; // of the nominal current; as measured in docs/design/ids.md

relay::RelayParams relay_params(ids::Model const& model, double nominal_peak_a, bool into_line) {
    relay::RelayParams out;
    out.element.samples_per_cycle = out.element.window_samples =
        static_cast<int>(std::lround(model.rate_hz / model.frequency_hz));
    out.element.pickup_a = kPickup * nominal_peak_a / std::numbers::sqrt2;
    out.element.slope_percent = kSlopePercent;
    out.from_positive = out.to_positive = into_line ? relay::Positive::into_line : relay::Positive::from_to;
    out.seal_in = false;
    out.required_synch = relay::Synch::none; // what it is, is in the table; the counters show whether they fit
    return out;
}

ForecastResult result_of(ids::StreamGuard const& guard, std::string why_not, double nominal_peak_a) {
    ForecastResult out;
    out.why_not = std::move(why_not);
    if (out.why_not.empty()) {
        out.samples = guard.counters().samples;
        out.flagged = guard.counters().open_flagged;
        out.sigma_percent = guard.sigma_percent();
        out.nominal_peak_a = nominal_peak_a;
    }
    return out;
}

} // namespace

Result<LineWatch> LineWatch::create(SvDescription const& from, SvDescription const& to,
                                    ForecastSettings const& settings) {
    for (SvDescription const* end : {&from, &to}) {
        if (!end->phases || !end->rate_known) {
            return fail(ExitCode::usage,
                        fmt::format("the currents of '{}' cannot be read: {}", end->stream.sv_id,
                                    end->phases ? "its rate is not known" : end->layout),
                        "describe the stream: --streams FILE, or --scl FILE");
        }
    }
    if (from.stream.rate_hz != to.stream.rate_hz) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' has {} samples a second and '{}' has {}: no two of them belong together",
                                from.stream.sv_id, from.stream.rate_hz.to_string(), to.stream.sv_id,
                                to.stream.rate_hz.to_string()));
    }
    relay::CurrentInputs::Params params;
    params.members = {*from.phases, *to.phases};
    auto inputs = relay::CurrentInputs::create(from.stream, to.stream, params);
    if (!inputs) {
        return std::unexpected{inputs.error()};
    }
    return LineWatch{std::move(*inputs), at_rate(*settings.model, from.stream.rate_hz.to_double()), settings};
}

void LineWatch::frame(iec61850::Octets octets, Place at) {
    auto const on_pair = [&](relay::LineSample const& sample) { take(sample, at); };
    inputs_.elapse(at.time_ns, on_pair);
    inputs_.frame(octets, at.time_ns, on_pair);
}

void LineWatch::take(relay::LineSample const& sample, Place at) {
    ++pairs_;
    if (sample.from.present) {
        from_meter_.add(sample.index, sample.from.i_a[0]);
    }
    if (sample.to.present) {
        to_meter_.add(sample.index, sample.to.i_a[0]);
    }
    Pair const pair{sample, at};
    if (detector_) {
        judge(pair);
        return;
    }
    first_.see(sample.from.i_a);
    first_.see(sample.to.i_a);
    if (!first_.wait(pair)) {
        begin();
    }
}

void LineWatch::begin() {
    double const nominal = nominal_peak_a_ > 0 ? nominal_peak_a_ : first_.peak_a();
    auto params = detector_params(model_, ids::Mode::supervise, nominal);
    std::vector<Pair> const waiting = first_.take();
    if (!params) {
        return; // no current yet
    }
    nominal_peak_a_ = nominal;
    params->along_the_line = !into_line_;
    detector_.emplace(model_, *params);
    relay_.emplace(relay_params(model_, nominal, into_line_));
    for (Pair const& pair : waiting) {
        judge(pair);
    }
}

void LineWatch::judge(Pair const& pair) {
    auto const input = [&](relay::EndSample const& end) {
        return ids::EndInput{end.i_a, relay::usable(end, relay_->params())};
    };
    relay::LineSample sample = pair.sample;
    ids::LineVerdict const& v =
        detector_->step(sample.index, input(sample.from), input(sample.to), relay_->output().pickup);
    relay_->step(sample, {v.granted});
    ids::Alarms const rose = v.alarms & ~before_;
    before_ = v.alarms;
    for (ids::Alarms bit = 1; bit != 0 && bit <= rose; bit <<= 1U) {
        if ((rose & bit) != 0) {
            alarms_.raise(ids::alarm_names(bit), pair.at);
        }
    }
}

void LineWatch::finish(Place at) {
    inputs_.elapse(at.time_ns, [&](relay::LineSample const& sample) { take(sample, at); });
    if (!detector_) {
        begin();
    }
}

void LineWatch::report(LineScan& out) const {
    double const wanted = model_.rate_hz / model_.frequency_hz;
    std::string const from = misfit(wanted, from_meter_.cycles()), to = misfit(wanted, to_meter_.cycles());
    out.pairs = pairs_;
    if (!detector_) {
        out.from_forecast.why_not = out.to_forecast.why_not = "no current";
        return;
    }
    out.from_forecast = result_of(detector_->from(), from, nominal_peak_a_);
    out.to_forecast = result_of(detector_->to(), to, nominal_peak_a_);
    out.pickup_a = relay_->params().element.pickup_a;
    out.pickups = relay_->counters().pickups;
    if (from.empty() && to.empty()) {
        out.alarms = alarms_.all();
    }
}

} // namespace gridspace::scan
