// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/comtrade_output.hpp"

#include "common/comtrade/comtrade_record.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/judge/run_network.hpp"
#include "launcher/judge/run_signals.hpp"
#include "launcher/judge/signal_rows.hpp"
#include "sim/app/sim_config.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <map>

namespace gridspace::launcher {
namespace {

using config::Node;
namespace fs = std::filesystem;

constexpr std::size_t kMaxRecords = 20; // of one run
Spans const kWholeRun{{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}};

/// Instants at which the trigger came, in nanoseconds of simulated time.
Result<std::vector<std::int64_t>> instants_of(Results const& r, Node const& scenario,
                                              ComtradeSettings const& settings) {
    std::vector<std::int64_t> out;
    auto const triggers = signals_within(r, settings.trigger_signals(), kWholeRun);
    if (!triggers) {
        return std::unexpected{triggers.error()};
    }
    for (std::string const& name : settings.trigger_signals()) {
        auto const it = triggers->find(name);
        if (it == triggers->end()) {
            continue;
        }
        bool set = true; // set from the beginning is no rise
        for (std::size_t i = 0; i < it->second.values.size(); ++i) {
            bool const now = it->second.values[i] != 0;
            if (now && !set) {
                out.push_back(it->second.times_ns[i]);
            }
            set = now;
        }
        return out;
    }
    Node const* events = scenario.find("events");
    Node const* event = events == nullptr ? nullptr : events->find(settings.trigger.name);
    if (Node const* at = event == nullptr ? nullptr : event->find("at_s")) {
        if (auto const seconds = config::number_of(*at); seconds && *seconds <= r.outcome.simulated_s) {
            out.push_back(std::llround(*seconds * 1e9));
        }
    }
    return out;
}

std::string trigger_signal(Results const& r, ComtradeSettings const& settings) {
    for (std::string const& name : settings.trigger_signals()) {
        if (r.signals.contains(name)) {
            return name;
        }
    }
    return {};
}

sim::SimulationConfig simulation_of(Node const& scenario) {
    sim::SimulationConfig simulation;
    config::Diagnostics ignored; // the run was started with it
    if (Node const* node = scenario.find("simulation")) {
        config::read_fields(*node, "simulation", ignored, [&](config::Fields& f) { describe(f, simulation); });
    }
    return simulation;
}

struct Ratio {
    double primary{1}, secondary{1};
};
using Ratios = std::map<std::string, Ratio>; ///< by the beginning of the transformer's signals: "ct.CT21"

/// "400:5" as 400 and 5.
std::optional<Ratio> ratio_of(std::string const& text) {
    std::vector<std::string> const parts = split(text, ':');
    if (parts.size() != 2) {
        return std::nullopt;
    }
    auto const primary = config::number_of(Node::scalar(parts[0])),
               secondary = config::number_of(Node::scalar(parts[1]));
    return primary && secondary ? std::optional{Ratio{*primary, *secondary}} : std::nullopt;
}

/// Of all instrument transformers of a network file.
Ratios ratios_of(Node const& network) {
    Ratios out;
    for (std::string const kind : {"ct", "vt"}) {
        Node const *transformers = network.find(kind + "s"), *types = network.find(kind + "_types");
        if (transformers == nullptr || types == nullptr) {
            continue;
        }
        for (Node::Entry const& entry : transformers->entries) {
            Node const* name = entry.value.find("type");
            Node const* type = name == nullptr ? nullptr : types->find(name->text);
            Node const* ratio = type == nullptr ? nullptr : type->find("ratio");
            if (auto const value = ratio == nullptr ? std::nullopt : ratio_of(ratio->text)) {
                out[kind + "." + entry.key] = *value;
            }
        }
    }
    return out;
}

/// "ct.CT21.i.a" is channel "CT21 Ia", phase A; "breaker.CB3.pole.a" is the auxiliary contact "CB3 52a A"; others keep
/// their name.
ComtradeChannel channel_of(std::string const& signal, std::string const& unit, bool digital) {
    std::vector<std::string> const parts = split(signal, '.');
    ComtradeChannel out{signal, "", unit};
    if (parts.size() == 4 && parts[3].size() == 1) {
        out.phase = std::string(1, static_cast<char>(std::toupper(parts[3][0])));
        out.circuit = parts[1];
        if (parts[0] == "ct" || parts[0] == "bus") {
            out.name = fmt::format("{} {}{}", parts[1], parts[0] == "ct" ? 'I' : 'V', parts[3]);
        } else if (digital && parts[2] == "pole") {
            out.name = fmt::format("{} 52a {}", parts[1], out.phase);
            out.normally_set = true;
        }
    } else if (digital && parts.size() == 3 && parts[0] == "relay") {
        out.name = parts[1] + " " + parts[2];
        out.circuit = parts[1];
    }
    return out;
}

/// Numbers of the first and last row of a record; row n is n periods of the signals after the begin of the run.
struct Rows {
    std::int64_t first{0}, last{0};
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(std::max<std::int64_t>(0, last - first + 1));
    }
};

Rows rows_around(double trigger_s, ComtradeSettings const& settings, double rate, double end_s) {
    double const from_s = std::max(0.0, trigger_s - settings.before_ms / 1e3),
                 to_s = std::min(end_s, trigger_s + settings.after_ms / 1e3);
    return {static_cast<std::int64_t>(std::ceil(from_s * rate - 1e-6)),
            static_cast<std::int64_t>(std::floor(to_s * rate + 1e-6))};
}

/// In nanoseconds of simulated time.
std::int64_t time_of(std::int64_t row, double rate) {
    return std::llround(static_cast<double>(row) / rate * 1e9);
}

class RecordMaker {
  public:
    RecordMaker(SignalStore const& signals, Ratios const& ratios, double rate, Rows rows)
        : signals_{signals}, ratios_{ratios}, rate_{rate}, rows_{rows} {}

    /// All signals that match, each once; false when there is none.
    bool add(std::string const& pattern, bool digital) {
        bool any = false;
        for (auto const& [name, series] : signals_) {
            if (!matches_glob(pattern, name)) {
                continue;
            }
            any = true;
            if (std::find(taken_.begin(), taken_.end(), name) == taken_.end()) {
                taken_.push_back(name);
                digital ? add_digital(name, series) : add_analog(name, series);
            }
        }
        return any;
    }
    ComtradeRecord record;

  private:
    /// What a signal holds at the instant of a row; not a number before its first value.
    std::vector<double> sampled(SignalSeries const& series) const {
        std::vector<double> out(rows_.count(), std::nan(""));
        std::size_t next = 0;
        for (std::size_t row = 0; row < out.size(); ++row) {
            std::int64_t const t = time_of(rows_.first + static_cast<std::int64_t>(row), rate_);
            while (next < series.times_ns.size() && series.times_ns[next] <= t) {
                ++next;
            }
            if (next > 0) {
                out[row] = series.values[next - 1];
            }
        }
        return out;
    }
    void add_analog(std::string const& name, SignalSeries const& series) {
        ComtradeChannel channel = channel_of(name, series.unit, false);
        std::vector<std::string> const parts = split(name, '.');
        if (auto const ratio = ratios_.find(parts.size() < 2 ? name : parts[0] + "." + parts[1]);
            ratio != ratios_.end()) {
            channel.primary = ratio->second.primary;
            channel.secondary = ratio->second.secondary;
        }
        record.header.analog.push_back(std::move(channel));
        record.analog.push_back(sampled(series));
    }
    void add_digital(std::string const& name, SignalSeries const& series) {
        bool const pole = name.starts_with("breaker.");
        std::vector<bool> values;
        for (double const v : sampled(series)) {
            values.push_back(pole ? v == kClosedPosition : std::isfinite(v) && v != 0);
        }
        record.header.digital.push_back(channel_of(name, "", true));
        record.digital.push_back(std::move(values));
    }

    SignalStore const& signals_;
    Ratios const& ratios_;
    double rate_;
    Rows rows_;
    std::vector<std::string> taken_;
};

/// Patterns of signals, and whether they are digital channels.
std::vector<std::pair<std::string, bool>> wanted_channels(ComtradeChannels const& usual,
                                                          ComtradeSettings const& settings) {
    std::vector<std::pair<std::string, bool>> wanted;
    for (std::string const& pattern : usual.analog) {
        wanted.emplace_back(pattern, false);
    }
    for (config::Ref const& pattern : settings.signals) {
        wanted.emplace_back(comtrade_pattern(pattern.name), false);
    }
    for (std::string const& pattern : usual.digital) {
        wanted.emplace_back(pattern, true);
    }
    return wanted;
}

/// `start`: of the names of the files, which are added to `files`.
Result<void> write_both_forms(ComtradeRecord const& record, fs::path const& start, bool single_file,
                              std::vector<fs::path>& files) {
    for (auto const& [format, ending] :
         {std::pair{ComtradeFormat::ascii, "ascii"}, {ComtradeFormat::binary, "binary"}}) {
        auto const file = write_comtrade(start.string() + "_" + ending, record, format,
                                         single_file ? ComtradeFiles::single : ComtradeFiles::pair);
        if (!file) {
            return std::unexpected{file.error()};
        }
        files.push_back(*file);
    }
    return {};
}

} // namespace

std::optional<ComtradeSettings> comtrade_settings(Node const& scenario) {
    Node const* record = scenario.find("record");
    Node const* node = record == nullptr ? nullptr : record->find("comtrade");
    if (node == nullptr || !node->is_map()) {
        return std::nullopt;
    }
    ComtradeSettings out;
    config::Diagnostics ignored;
    config::read_fields(*node, "record.comtrade", ignored, [&](config::Fields& f) { describe(f, out); });
    return out;
}

Result<ComtradeOutput> write_comtrade_records(Results const& r, Node const& scenario, ComtradeSettings const& settings,
                                              fs::path const& folder) {
    ComtradeOutput out;
    auto found = instants_of(r, scenario, settings);
    if (!found) {
        return std::unexpected{found.error()};
    }
    std::vector<std::int64_t> instants = std::move(*found);
    if (instants.empty()) {
        out.notes.push_back(fmt::format("'{}' did not happen: nothing to write", settings.trigger.name));
        return out;
    }
    if (instants.size() > kMaxRecords) {
        out.notes.push_back(fmt::format("'{}' happened {} times: the first {} are written", settings.trigger.name,
                                        instants.size(), kMaxRecords));
        instants.resize(kMaxRecords);
    }
    std::error_code error;
    fs::create_directories(folder, error);
    sim::SimulationConfig const simulation = simulation_of(scenario);
    double const rate = sim::signal_rate_hz(simulation).to_double();
    Node const network = network_of_run(r.folder, scenario);
    Ratios const ratios = ratios_of(network);
    auto const wanted = wanted_channels(usual_channels(scenario, trigger_signal(r, settings)), settings);
    std::vector<Rows> records;
    Spans spans;
    for (std::int64_t const instant : instants) {
        records.push_back(rows_around(static_cast<double>(instant) / 1e9, settings, rate, r.outcome.simulated_s));
        spans.emplace_back(time_of(records.back().first, rate), time_of(records.back().last, rate));
    }
    std::vector<std::string> patterns;
    std::ranges::transform(wanted, std::back_inserter(patterns), [](auto const& channel) { return channel.first; });
    auto const signals = signals_within(r, patterns, spans);
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    for (std::size_t n = 0; n < instants.size(); ++n) {
        RecordMaker maker{*signals, ratios, rate, records[n]};
        for (auto const& [pattern, digital] : wanted) {
            if (!maker.add(pattern, digital) && n == 0) {
                out.notes.push_back(fmt::format("no recorded signal matches '{}'", pattern));
            }
        }
        if (maker.record.header.analog.empty() && maker.record.header.digital.empty()) {
            out.notes.push_back("nothing that was recorded is a channel of such a record: name signals (--signals, or "
                                "record.comtrade.signals)");
            return out;
        }
        ComtradeHeader& header = maker.record.header;
        header.station = r.scenario;
        header.device = settings.trigger.name.substr(0, settings.trigger.name.find('.'));
        header.line_frequency_hz = frequency_of_run(r.folder);
        header.sample_rate_hz = rate;
        std::int64_t const epoch_ns = r.epoch_unix_s * 1'000'000'000;
        header.start_unix_ns = epoch_ns + time_of(records[n].first, rate);
        header.trigger_unix_ns = epoch_ns + instants[n];
        if (auto ok = write_both_forms(maker.record,
                                       folder / fmt::format("{}_{}", as_file_name(settings.trigger.name), n + 1),
                                       settings.single_file, out.files);
            !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return out;
}

Result<ComtradeOutput> write_comtrade_of_run(Results const& r) {
    config::Diagnostics ignored;
    auto const scenario = config::load_yaml(r.folder / "scenario.resolved.yaml", ignored);
    auto const settings = scenario ? comtrade_settings(*scenario) : std::nullopt;
    return settings ? write_comtrade_records(r, *scenario, *settings, r.folder / "comtrade")
                    : Result<ComtradeOutput>{ComtradeOutput{}};
}

} // namespace gridspace::launcher
