// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/training/training_config.hpp"

#include "common/config/merge.hpp"
#include "ids/training/chunks.hpp"

#include <fmt/format.h>

namespace gridspace::ids {
namespace {

void range(config::Fields& f, std::string_view key, std::array<double, 2>& value, config::NumberSpec spec) {
    std::vector<double> both{value[0], value[1]};
    f.numbers(key, both, spec);
    if (!f.has(key)) {
        return;
    }
    if (both.size() != 2 || both[0] > both[1]) {
        f.error(key, "two numbers expected, the smaller first",
                fmt::format("e.g. {}: [{}, {}]", key, value[0], value[1]));
        return;
    }
    value = {both[0], both[1]};
}

void describe_synthetic(config::Fields& f, TrainingConfig& c) {
    SyntheticParams& s = c.synthetic;
    f.integer("recordings", c.synthetic_recordings,
              {.doc = "how many; the ten situations in turn", .required = true, .min = 1, .max = 100'000});
    f.number("duration_s", s.duration_s, {.doc = "of each", .max = 60, .above = 0});
    f.number("nominal_peak_a", s.nominal_peak_a, {.doc = "crest of the nominal current", .above = 0});
    range(f, "event_s", s.event_s, {.doc = "when the event happens", .min = 0});
    range(f, "load", s.load, {.doc = "of the nominal current", .min = 0});
    range(f, "noise_percent", s.noise_percent, {.doc = "standard deviation, of the nominal peak", .min = 0, .max = 50});
    f.number("harmonics_percent", s.harmonics_percent,
             {.doc = "3rd, 5th and 7th: each up to this", .min = 0, .max = 50});
    f.number("off_nominal_share", s.off_nominal_share,
             {.doc = "share of recordings with another frequency", .min = 0, .max = 1});
    f.number("frequency_spread_hz", s.frequency_spread_hz, {.doc = "how much another", .min = 0, .max = 5});
    f.number("ct_error_percent", s.ct_error_percent,
             {.doc = "standard deviation of the ratio error", .min = 0, .max = 20});
    range(f, "fault", s.fault, {.doc = "peak of the fault current, of the nominal peak", .above = 0});
    range(f, "x_over_r", s.x_over_r, {.doc = "of the network", .above = 0});
    f.number("radial_share", s.radial_share, {.doc = "internal faults fed from one end only", .min = 0, .max = 1});
    f.number("quantum_a", s.quantum_a, {.doc = "resolution of the samples", .min = 0});
}

void describe_simulated(config::Fields& f, SimulatedParams& s) {
    f.file("network", s.network, {.doc = "network file", .required = true});
    f.text("line", s.line, {.doc = "the protected line", .required = true});
    f.text("from_ct", s.from_ct, {.doc = "current transformer of its `from` end", .required = true});
    f.text("to_ct", s.to_ct, {.doc = "current transformer of its `to` end", .required = true});
    f.integer("runs", s.runs, {.doc = "how many; the situations in turn", .required = true, .min = 1, .max = 10'000});
    f.number("duration_s", s.duration_s, {.doc = "of each", .max = 60, .above = 0});
    f.fraction("step_s", s.step_s,
               {.doc = "solver step; a sample is a whole number of steps", .max = 1e-3, .above = 0});
    f.number("harmonics_percent", s.harmonics_percent,
             {.doc = "3rd, 5th and 7th at both ends: each up to this, of the nominal peak", .min = 0, .max = 50});
    range(f, "event_s", s.event_s, {.doc = "when the event happens", .min = 0});
    range(f, "fault_resistance_ohm", s.fault_resistance_ohm, {.doc = "log-uniform", .above = 0});
    range(f, "noise_percent", s.noise_percent, {.doc = "standard deviation, of the nominal peak", .min = 0, .max = 50});
    range(f, "load_factor", s.load_factor, {.doc = "by which each load is multiplied", .min = 0, .max = 10});
    f.number("ct_error_percent", s.ct_error_percent,
             {.doc = "standard deviation of the ratio error", .min = 0, .max = 20});
    f.number("nominal_peak_a", s.nominal_peak_a, {.doc = "crest of the nominal current", .required = true, .above = 0});
}

void describe_model(config::Fields& m, TrainingConfig& c) {
    m.integer("window", c.window, {.doc = "samples that it sees", .min = 1, .max = 4096});
    m.integer("hidden", c.hidden, {.doc = "tanh neurons; 0: linear", .min = 0, .max = 1000});
    m.integer("channels", c.channels, {.doc = "1: each phase for itself; 3: all together", .min = 1, .max = 3});
    m.choice<Model::Scale>("scale", c.scale,
                           {{"window_peak", Model::Scale::window_peak}, {"fixed", Model::Scale::fixed}},
                           {.doc = "what samples are divided by: the peak of the window, or scale_a"});
    m.number("scale_a", c.scale_a, {.doc = "fixed: the scale; window_peak: the least", .above = 0});
    if (c.channels == 2) {
        m.error("channels", "1 or 3 are possible");
    }
}

void describe_training(config::Fields& t, TrainingConfig& c) {
    using Method = TrainParams::Method;
    std::int64_t epochs = c.training.epochs, batch = c.training.batch, threads = c.training.threads;
    t.choice<Method>("method", c.training.method,
                     {{"huber", Method::huber},
                      {"least_squares", Method::least_squares},
                      {"back_propagation", Method::back_propagation},
                      {"levenberg_marquardt", Method::levenberg_marquardt}},
                     {.doc = "linear: huber, least_squares; network: back_propagation, levenberg_marquardt"});
    t.integer("epochs", epochs, {.doc = "passes, or iterations", .min = 1, .max = 100'000});
    t.number("rate", c.training.rate, {.doc = "back-propagation: first step size; falls to a twentieth", .above = 0});
    t.number("momentum", c.training.momentum, {.doc = "back-propagation", .min = 0, .below = 1});
    t.integer("batch", batch, {.doc = "back-propagation: windows a step", .min = 1, .max = 100'000});
    t.number("huber", c.training.huber,
             {.doc = "linear: robust standard deviations beyond which errors count linearly", .above = 0});
    t.number("error_limit", c.training.error_limit, {.doc = "networks: the same in scaled units", .above = 0});
    t.integer("threads", threads, {.doc = "changes the time, not the result", .min = 1, .max = 256});
    t.integer("windows", c.windows, {.doc = "training pairs that are drawn", .min = 10, .max = 100'000'000});
    t.number("event_share", c.event_share,
             {.doc = "share of them from the cycle after an event, at most", .min = 0, .max = 1});
    c.training.epochs = static_cast<int>(epochs);
    c.training.batch = static_cast<int>(batch);
    c.training.threads = static_cast<int>(threads);
}

void describe_data(config::Fields& d, TrainingConfig& c) {
    bool any = false;
    any |= d.object("synthetic", {.doc = "recordings in closed form"},
                    [&](config::Fields& s) { describe_synthetic(s, c); });
    SimulatedParams simulated;
    if (d.object("simulated", {.doc = "runs of the electromagnetic simulator"},
                 [&](config::Fields& s) { describe_simulated(s, simulated); })) {
        c.simulated = simulated;
        any = true;
    }
    d.list("files", {.doc = "recordings (CSV, npy)"}, [&](config::Fields& l) {
        TrainingConfig::File file;
        std::optional<double> rate, event;
        l.file("file", file.file, {.doc = "CSV with a time column, or npy", .required = true});
        l.number("rate_hz", rate, {.doc = "npy: samples a second", .above = 0});
        l.number("event_s", event, {.doc = "when something happens", .min = 0});
        file.options = {rate, c.frequency_hz, event};
        c.files.push_back(file);
        any = true;
    });
    if (!any) {
        d.error("", "no data", "give synthetic, simulated or files");
    }
}

} // namespace

void describe(config::Fields& f, TrainingConfig& c) {
    std::int64_t version = 1;
    f.integer("gridspace_ids_training", version,
              {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", c.name, {.doc = "of the model", .required = true});
    f.integer("seed", c.seed, {.doc = "of everything random", .min = 0});
    f.file("output", c.output, {.doc = "model file that is written", .required = true});
    f.number("rate_hz", c.rate_hz, {.doc = "samples a second", .max = 1e6, .above = 0});
    f.number("frequency_hz", c.frequency_hz, {.doc = "nominal frequency", .max = 1000, .above = 0});
    f.object("model", {.doc = "its shape"}, [&](config::Fields& m) { describe_model(m, c); });
    f.object("training", {.doc = "how"}, [&](config::Fields& t) { describe_training(t, c); });
    c.training.hidden = static_cast<int>(c.hidden);
    f.object("data", {.doc = "what it learns from; all of these together", .required = true},
             [&](config::Fields& d) { describe_data(d, c); });
    c.synthetic.rate_hz = c.rate_hz;
    c.synthetic.frequency_hz = c.frequency_hz;
}

std::optional<TrainingConfig> load_training_config(std::filesystem::path const& file,
                                                   config::Diagnostics& diagnostics) {
    auto const node = config::load_extended(file, diagnostics);
    if (!node) {
        return std::nullopt;
    }
    TrainingConfig out;
    config::read_fields(*node, "", diagnostics, [&](config::Fields& f) { describe(f, out); });
    return diagnostics.ok() ? std::optional{out} : std::nullopt;
}

Result<std::vector<LineWaveform>> gather_recordings(TrainingConfig const& c, std::uint64_t seed,
                                                    std::uint64_t number_offset) {
    std::vector<LineWaveform> out(static_cast<std::size_t>(c.synthetic_recordings));
    for_each_chunk(out.size(), c.training.threads, [&](std::size_t k) {
        out[k] = synthesise(c.synthetic, static_cast<Situation>(k % 10), seed, number_offset + k);
    });
    for (TrainingConfig::File const& f : c.files) {
        auto read = read_recording(f.file, f.options);
        if (!read) {
            return std::unexpected{read.error()};
        }
        if (std::abs(read->rate_hz - c.rate_hz) > 1e-6 * c.rate_hz) {
            return fail(
                ExitCode::usage,
                fmt::format("{}: {} samples a second; rate_hz is {}", f.file.string(), read->rate_hz, c.rate_hz),
                "resample it, or change rate_hz");
        }
        out.push_back(std::move(*read));
    }
    return out;
}

Model blank_model(TrainingConfig const& c) {
    Model m;
    m.name = c.name;
    m.kind = c.hidden > 0 ? "mlp" : c.channels == 3 ? "joint" : "ar";
    m.window = static_cast<int>(c.window);
    m.channels = static_cast<int>(c.channels);
    m.rate_hz = c.rate_hz;
    m.frequency_hz = c.frequency_hz;
    m.scale = c.scale;
    m.scale_a = c.scale_a;
    return m;
}

} // namespace gridspace::ids
