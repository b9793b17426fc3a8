// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace ids score`: any detector's verdicts and alarms against what really happened in a run.
#include "launcher/cli/checks.hpp"
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/manifest.hpp"
#include "launcher/ids/score/verdict_score.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct IdsScoreArguments {
    std::filesystem::path run, verdicts; ///< no verdicts: the alarms that the run itself recorded
    std::optional<double> threshold;
    std::int64_t seed{1};
    bool others_are_genuine{false}, json{false};
};

constexpr std::uintmax_t kLargestFile = 1U << 30U;

Json to_json(ids::Estimate const& e) {
    auto const number = [](std::optional<double> const& v) { return v ? Json(*v) : Json(nullptr); };
    return {{"value", number(e.value)}, {"low", number(e.low)}, {"high", number(e.high)}};
}

Json to_json(launcher::AlarmScore const& s) {
    Json out{{"count", s.alarms},
             {"false", s.false_alarms},
             {"genuine_s", s.genuine_s},
             {"false_s", s.false_s},
             {"attacks", Json::array()}};
    for (launcher::AlarmScore::Attack const& a : s.attacks) {
        out["attacks"].push_back({{"attack", a.span.attack},
                                  {"kind", a.span.kind},
                                  {"target", a.span.target},
                                  {"from_s", a.span.from_s},
                                  {"to_s", a.span.to_s},
                                  {"alarmed", a.delay_ms.has_value()},
                                  {"delay_ms", a.delay_ms ? Json(*a.delay_ms) : Json(nullptr)},
                                  {"by", a.by.empty() ? Json(nullptr) : Json(a.by)}});
    }
    return out;
}

void print_alarms(launcher::AlarmScore const& s) {
    fmt::print("alarms: {}, {} of them without an attack", s.alarms, s.false_alarms);
    fmt::print("; without one an alarm stood for {:.4g} of {:.4g} s\n", s.false_s, s.genuine_s);
    fmt::print("{:<22}{:<16}{:<16}{:>12}{:>12}{:>18}  {}\n", "attack", "kind", "on", "from, s", "until, s",
               "first alarm, ms", "by");
    for (launcher::AlarmScore::Attack const& a : s.attacks) {
        fmt::print("{:<22}{:<16}{:<16}{:>12.6g}{:>12.6g}{:>18}  {}\n", a.span.attack, a.span.kind, a.span.target,
                   a.span.from_s, a.span.to_s, a.delay_ms ? fmt::format("{:.3f}", *a.delay_ms) : "none", a.by);
    }
}

void print_alarms_alone(launcher::AlarmScore const& s, IdsScoreArguments const& a) {
    if (!a.json) {
        print_alarms(s);
        return;
    }
    Json out{{"run", a.run.string()},
             {"verdicts", a.verdicts.empty() ? Json(nullptr) : Json(a.verdicts.string())},
             {"alarms", to_json(s)}};
    fmt::print("{}\n", out.dump(2));
}

void print_json(score::VerdictScore const& s, IdsScoreArguments const& a) {
    ids::VerdictQuality const& q = s.quality;
    Json out{{"run", a.run.string()},
             {"verdicts", a.verdicts.string()},
             {"unit", s.by_phase ? "phase-sample" : "sample"},
             {"judged", s.judged},
             {"altered", s.altered},
             {"altered_without_verdict", s.altered_unjudged},
             {"true_positives", q.true_positives},
             {"false_positives", q.false_positives},
             {"true_negatives", q.true_negatives},
             {"false_negatives", q.false_negatives},
             {"precision", to_json(q.precision)},
             {"recall", to_json(q.recall)},
             {"f1", to_json(q.f1)},
             {"false_positive_rate", to_json(q.false_positive_rate)},
             {"auc", to_json(q.auc)},
             {"seed", a.seed},
             {"attacks", Json::array()},
             {"messages_not_judged", s.messages_not_judged},
             {"alarms", to_json(s.alarms)},
             {"roc", Json::array()}};
    for (auto const& attack : s.attacks) {
        out["attacks"].push_back({{"attack", attack.score.attack},
                                  {"kind", attack.kind},
                                  {"target", attack.target},
                                  {"altered", attack.score.labels},
                                  {"found_percent", attack.score.detected.percent},
                                  {"seen", attack.score.seen},
                                  {"delay_ms", attack.delay_ms ? Json(*attack.delay_ms) : Json(nullptr)}});
    }
    out["kinds"] = Json::array();
    for (auto const& kind : s.kinds) {
        out["kinds"].push_back({{"kind", kind.kind},
                                {"attacks", kind.attacks},
                                {"seen", kind.seen},
                                {"altered", kind.recall.of},
                                {"recall_percent", kind.recall.percent},
                                {"low_percent", kind.recall.low_percent},
                                {"high_percent", kind.recall.high_percent}});
    }
    for (auto const& point : q.roc) {
        out["roc"].push_back({{"threshold", point.threshold},
                              {"false_positive_rate", point.false_positive_rate},
                              {"recall", point.recall}});
    }
    fmt::print("{}\n", out.dump(2));
}

void print_estimate(char const* name, ids::Estimate const& e, double unit, char const* suffix) {
    if (!e.value) {
        fmt::print("{:<22}{:>12}   nothing to count\n", name, "-");
        return;
    }
    fmt::print("{:<22}{:>12}{}\n", name, fmt::format("{:.4g}{}", *e.value * unit, suffix),
               e.low ? fmt::format("   {:.4g} to {:.4g}", *e.low * unit, *e.high * unit) : "");
}

void print_text(score::VerdictScore const& s, IdsScoreArguments const& a) {
    ids::VerdictQuality const& q = s.quality;
    char const* const unit = s.by_phase ? "phase-samples" : "samples";
    fmt::print("{} {} have a verdict; {} were altered", s.judged, unit, s.altered);
    fmt::print("{}\n\n", s.altered_unjudged > 0
                             ? fmt::format(", {} of these have no verdict and count as missed", s.altered_unjudged)
                             : "");
    fmt::print("{:<22}{:>12}   95 % (bootstrap of blocks of 0.1 s, seed {})\n", "", "", a.seed);
    print_estimate("precision", q.precision, 100, " %");
    print_estimate("recall", q.recall, 100, " %");
    print_estimate("F1", q.f1, 100, " %");
    print_estimate("false positive rate", q.false_positive_rate, 100, " %");
    if (s.has_scores) {
        print_estimate("area below the ROC", q.auc, 1, "");
    }
    fmt::print("\n{:<22}{:>12}{:>12}\n", "", "flagged", "not");
    fmt::print("{:<22}{:>12}{:>12}\n", "altered", q.true_positives, q.false_negatives);
    fmt::print("{:<22}{:>12}{:>12}\n", "genuine", q.false_positives, q.true_negatives);
    fmt::print("\n{:<22}{:<16}{:<16}{:>10}{:>12}{:>18}\n", "attack", "kind", "on", "altered", "found, %",
               "first found, ms");
    for (auto const& attack : s.attacks) {
        fmt::print("{:<22}{:<16}{:<16}{:>10}{:>12.4g}{:>18}\n", attack.score.attack, attack.kind, attack.target,
                   attack.score.labels, attack.score.detected.percent,
                   attack.delay_ms ? fmt::format("{:.3f}", *attack.delay_ms) : "never");
    }
    fmt::print("\n{:<22}{:>10}{:>10}{:>10}{:>12}   95 % (binomial)\n", "kind", "attacks", "seen", "altered",
               "recall, %");
    for (auto const& kind : s.kinds) {
        fmt::print("{:<22}{:>10}{:>10}{:>10}{:>12.4g}   {:.4g} to {:.4g} %\n", kind.kind, kind.attacks, kind.seen,
                   kind.recall.of, kind.recall.percent, kind.recall.low_percent, kind.recall.high_percent);
    }
    fmt::print("\n");
    print_alarms(s.alarms);
    for (auto const& [attack, labels] : s.messages_not_judged) {
        fmt::print("note: '{}' altered {} messages, about which a verdict on a sample says nothing; a list of alarms "
                   "(time_s,alarm) does\n",
                   attack, labels);
    }
}

Result<std::string> text_of(std::filesystem::path const& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return fail(ExitCode::usage, fmt::format("{}: no such file", file.string()));
    }
    if (std::filesystem::file_size(file, error) > kLargestFile) {
        return fail(ExitCode::usage, fmt::format("{}: larger than 1 GB", file.string()), "split it");
    }
    std::ifstream stream{file, std::ios::binary};
    return std::string{std::istreambuf_iterator<char>{stream}, {}};
}

/// The alarms of the detectors and of the first-line rules that were in the loop.
int score_recorded(score::Truth const& truth, std::filesystem::path const& run, IdsScoreArguments const& a) {
    auto const signals = read_signals(run / "data.mcap", launcher::is_alarm_signal);
    if (!signals) {
        return print_error(signals.error());
    }
    if (signals->empty()) {
        return print_error({ExitCode::usage, fmt::format("'{}' has no signal of an alarm", run.string()),
                            "a relay with `ids:` publishes ids.PROCESS.alarm; or give a file with verdicts or alarms"});
    }
    double const end_s = truth.extent.end_s;
    print_alarms_alone(launcher::score_alarms(truth.attacks, launcher::raised_alarms(*signals, end_s), end_s), a);
    return 0;
}

int ids_score(IdsScoreArguments const& a) {
    auto const run = closed_run(a.run);
    if (!run) {
        return print_error(run.error());
    }
    auto const truth = score::read_truth(*run, reached_of(manifest_of(*run)));
    if (!truth) {
        return print_error(truth.error());
    }
    if (a.verdicts.empty()) {
        return score_recorded(*truth, *run, a);
    }
    auto const text = text_of(a.verdicts);
    if (!text) {
        return print_error(text.error());
    }
    config::Diagnostics diagnostics;
    auto verdicts = score::parse_verdicts(*text, a.verdicts.string(), truth->extent, a.threshold, diagnostics);
    if (!verdicts) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    if (verdicts->is_alarms) {
        print_alarms_alone(
            launcher::score_alarms(truth->attacks, score::alarms_of(*verdicts, truth->extent), truth->extent.end_s), a);
        return 0;
    }
    if (truth->labels.empty()) {
        return print_error({ExitCode::usage,
                            fmt::format("'{}' holds no label of a stream of sampled values", run->string()),
                            "verdicts on samples judge attacks on these; a list of alarms (time_s,alarm) judges all"});
    }
    auto const found =
        score::score_verdicts(*truth, std::move(*verdicts), a.others_are_genuine, static_cast<std::uint64_t>(a.seed));
    a.json ? print_json(found, a) : print_text(found, a);
    return 0;
}

} // namespace

void add_ids_score(Command ids, Action& action) {
    auto const a = std::make_shared<IdsScoreArguments>();
    Command verb =
        ids.add_subcommand("score", "judge a detector's verdicts or alarms by what really happened in a run");
    verb.add_option("RUN", a->run, "run folder with labels, or the name of a run").required();
    verb.add_option(
        "VERDICTS", a->verdicts,
        "CSV: stream, sample or time_s, phase, verdict or score; or time_s and alarm. Without it: the alarms "
        "that the run recorded");
    verb.add_option("--threshold", a->threshold, "flagged from this score on, whatever the verdict says");
    verb.add_flag("--others-genuine", a->others_are_genuine,
                  "samples without a row count as verdict 0: the file is a list of alarms");
    verb.add_option("--seed", a->seed, "of the bootstrap").check(not_negative());
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return ids_score(*a); }; });
}

} // namespace gridspace::cli
