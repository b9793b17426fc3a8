// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace: the command line. Parses; the verbs do the work.
#include "common/exit_code.hpp"
#include "common/text.hpp"
#include "common/version.hpp"
#include "launcher/cli/bundle_verb.hpp"
#include "launcher/cli/completion.hpp"
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/live_verbs.hpp"
#include "launcher/cli/play_verb.hpp"
#include "launcher/cli/scl_verbs.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/cli/wire_verbs.hpp"
#include "launcher/run/say.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace gridspace::cli {

int version(bool json) {
    Version const& v = gridspace::version();
    if (json) {
        fmt::print("{}\n",
                   nlohmann::ordered_json{
                       {"version", v.version}, {"commit", v.commit}, {"build", v.build_type}, {"compiler", v.compiler}}
                       .dump());
    } else {
        fmt::print("{}\n", version_text("gridspace"));
    }
    return 0;
}

namespace {

/// The verbs that were added to `app`, with their options: the completion scripts cannot forget one.
std::vector<VerbOptions> verbs_of(CLI::App const& app) {
    std::vector<VerbOptions> out;
    for (CLI::App const* verb : app.get_subcommands([](CLI::App const*) { return true; })) {
        VerbOptions entry{verb->get_name(), verb->get_description(), {}};
        for (CLI::Option const* option : verb->get_options()) {
            for (std::string const& name : option->get_lnames()) {
                entry.options.push_back("--" + name);
            }
        }
        out.push_back(std::move(entry));
    }
    return out;
}

void scenario_options(CLI::App* verb, ScenarioArguments& a) {
    verb->add_option("SCENARIO", a.file, "scenario file (YAML)")->required();
    verb->add_option("--set", a.set, "override a value: --set clock.tick_s=0.25 (may be repeated)")
        ->take_all()
        ->allow_extra_args(false);
    verb->add_option("--speed", a.speed, "simulated seconds per second, or max");
    verb->add_option("--until", a.until, "end at this simulated time: 10s, 5min, 2h");
    verb->add_option("--seed", a.seed, "seed of everything random");
    verb->add_option("--allow-attacks-on", a.allow_attacks_on,
                     "an interface that is not a virtual cable, for an attacker with `interface:`");
}

void add_ids_verbs(CLI::App& app, std::function<int()>& action, IdsTrainArguments& train,
                   IdsEvaluateArguments& evaluate, IdsStudyArguments& study) {
    CLI::App* ids_verb = app.add_subcommand("ids", "train and judge the forecasters of the intrusion detector");
    ids_verb->require_subcommand(1);
    CLI::App* t = ids_verb->add_subcommand("train", "train a forecaster");
    t->add_option("CONFIG", train.config, "training configuration (YAML)")->required();
    t->add_option("--out", train.output, "model file instead of the configuration's");
    t->add_option("--seed", train.seed, "seed instead of the configuration's")->check(CLI::NonNegativeNumber);
    t->add_flag("--json", train.json, "the result as JSON");
    t->add_flag("--quiet", train.quiet, "no progress");
    t->callback([&] { action = [&] { return ids_train(train); }; });

    CLI::App* e = ids_verb->add_subcommand(
        "evaluate", "judge a forecaster: false positives by situation, error, detection by attack");
    e->add_option("MODEL", evaluate.model, "model file (JSON)")->required();
    e->add_option("DATA", evaluate.data,
                  "recordings (CSV, npy), or a training configuration for unseen ones of its kind")
        ->required();
    e->add_option("--percent", evaluate.percent, "threshold")->check(CLI::PositiveNumber);
    e->add_option("--nominal-peak-a", evaluate.nominal_peak_a,
                  "crest of the nominal current (default: the largest of the first two cycles)")
        ->check(CLI::PositiveNumber);
    e->add_option("--rate-hz", evaluate.rate_hz, "samples a second, for npy")->check(CLI::PositiveNumber);
    e->add_option("--event-s", evaluate.event_s, "when something happens in the recordings")
        ->check(CLI::NonNegativeNumber);
    e->add_option("--threshold", evaluate.threshold, "what the threshold of the attack table is relative to")
        ->check(CLI::IsMember({"instantaneous", "nominal_peak", "running_peak", "larger_peak", "adaptive"}));
    e->add_option("--seed", evaluate.seed, "of unseen recordings and attacks")->check(CLI::NonNegativeNumber);
    e->add_flag("!--no-attacks", evaluate.attacks, "only the false positives");
    e->add_flag("--json", evaluate.json, "as JSON");
    e->callback([&] { action = [&] { return ids_evaluate(evaluate); }; });

    CLI::App* s = ids_verb->add_subcommand(
        "study", "window and neurons against error and time; fakes in a row against the published loop");
    s->add_option("CONFIG", study.config,
                  "training configuration (YAML): its data are used (default: closed-form recordings)");
    s->add_option("--windows", study.windows, "window lengths")->delimiter(',')->check(CLI::Range(1, 4096));
    s->add_option("--hidden", study.hidden, "neurons; a linear forecaster is always tried too")
        ->delimiter(',')
        ->check(CLI::Range(0, 1000));
    s->add_option("--out", study.out, "folder for tables and figures");
    s->add_flag("--json", study.json, "as JSON");
    s->callback([&] { action = [&] { return ids_study(study); }; });
}

/// What is said about a command line that cannot be read: the word that is no verb by its name, with those that are
/// near.
std::string mistake(CLI::App const* app, CLI::Error const& error) {
    CLI::App const* verb = app;
    std::string path = app->get_name();
    while (!verb->get_subcommands().empty()) {
        verb = verb->get_subcommands().front();
        path += " " + verb->get_name();
    }
    std::vector<std::string> verbs;
    for (CLI::App const* known : verb->get_subcommands([](CLI::App const* sub) { return !sub->get_group().empty(); })) {
        verbs.push_back(known->get_name());
    }
    std::vector<std::string> const rest = app->remaining(true);
    std::string const said =
        !verbs.empty() && !rest.empty() && !rest.front().starts_with("-")
            ? fmt::format("`{}` has no verb '{}'\n  {}", path, rest.front(), spelling_hint(rest.front(), verbs))
            : error.what();
    return fmt::format("error: {}\n  `{} --help` shows what there is\n", said, path);
}

int main_function(int argc, char** argv) {
    CLI::App app{"Gridspace: smart-grid co-simulation over DDS and IEC 61850", "gridspace"};
    app.require_subcommand(0, 1);
    app.set_help_all_flag("--help-all", "help of all verbs");
    bool show_version = false, version_json = false;
    app.add_flag("--version", show_version, "version of this build");
    app.add_flag("--json", version_json, "with --version: as JSON");
    std::function<int()> action;
    auto const verb = [&](char const* name, char const* description) { return app.add_subcommand(name, description); };

    RunArguments run_arguments;
    CLI::App* run_verb = verb("run", "run a scenario: start, watch, record, judge, report");
    scenario_options(run_verb, run_arguments.scenario);
    run_verb->add_flag("--dry-run", run_arguments.dry_run, "show what would be started");
    run_verb->add_option("--out", run_arguments.out, "run folder (default: runs/<scenario>-<utc>)");
    run_verb->add_option("--junit", run_arguments.junit, "write the expectations as JUnit XML");
    run_verb->add_flag("--json", run_arguments.json, "progress as JSON lines, the summary as JSON");
    run_verb->add_flag("--quiet", run_arguments.quiet, "print nothing but errors");
    run_verb->add_flag("--no-namespaces", run_arguments.no_namespaces, "everything on the loopback interface");
    run_verb->add_flag("--no-deadlines", run_arguments.no_deadlines, "wait for ever (a debugger is attached)");
    run_verb->add_flag("--allow-control", run_arguments.allow_control,
                       "pause, continue, step and stop it from the dashboard and the command line");
    run_verb->add_option("--log-level", run_arguments.log_level, "of the processes")
        ->check(CLI::IsMember({"debug", "info", "warning", "error"}));
    run_verb->callback([&] { action = [&] { return run(run_arguments); }; });

    ValidateArguments validate_arguments;
    CLI::App* validate_verb = verb("validate", "check scenario and network files; start nothing");
    validate_verb->add_option("FILE", validate_arguments.files, "files")->required();
    validate_verb->add_option("--set", validate_arguments.set, "override a value")->take_all()->allow_extra_args(false);
    std::string format = "text";
    validate_verb->add_option("--format", format, "text or json")->check(CLI::IsMember({"text", "json"}));
    validate_verb->callback([&] {
        action = [&] {
            validate_arguments.json = format == "json";
            return validate(validate_arguments);
        };
    });

    ScenarioArguments signals_arguments;
    bool signals_json = false;
    CLI::App* signals_verb = verb("signals", "list the signals of a scenario: name, unit, rate");
    scenario_options(signals_verb, signals_arguments);
    signals_verb->add_flag("--json", signals_json, "as JSON");
    signals_verb->callback([&] { action = [&] { return signals(signals_arguments, signals_json); }; });

    PowerFlowArguments powerflow_arguments;
    CLI::App* powerflow_verb = verb("powerflow", "solve the power flow of a network (YAML or MATPOWER)");
    powerflow_verb->add_option("NETWORK", powerflow_arguments.network, "network file")->required();
    powerflow_verb->add_flag("--json", powerflow_arguments.json, "as JSON");
    powerflow_verb->add_flag("--enforce-q-limits", powerflow_arguments.enforce_q_limits,
                             "generators give up their voltage at their reactive limits");
    powerflow_verb->add_flag("--three-phase", powerflow_arguments.three_phase,
                             "unbalanced: voltages and currents by phase");
    powerflow_verb->callback([&] { action = [&] { return powerflow(powerflow_arguments); }; });

    SimulateArguments simulate_arguments;
    CLI::App* simulate_verb = verb("simulate", "simulate a network offline: waveforms or phasors to CSV or COMTRADE");
    simulate_verb->add_option("NETWORK", simulate_arguments.network, "network file (YAML or MATPOWER)")->required();
    simulate_verb->add_option("--events", simulate_arguments.events, "YAML file with `events:` as in a scenario");
    simulate_verb->add_flag("--fixed-step", simulate_arguments.fixed_step,
                            "phasor: steps of --step, not of the integrator's choice");
    simulate_verb->add_option("--solver", simulate_arguments.solver, "emt (waveforms) or phasor")
        ->check(CLI::IsMember({"emt", "phasor"}));
    simulate_verb->add_option("--until", simulate_arguments.until, "end at this simulated time: 10s, 5min, 2h");
    simulate_verb->add_option("--step", simulate_arguments.step,
                              "time step in seconds (default: 1/48000 for emt, 1/1000 for phasor)");
    simulate_verb
        ->add_option("--signals", simulate_arguments.signals, "what is written: names or patterns, separated by commas")
        ->delimiter(',');
    simulate_verb->add_flag("--list-signals", simulate_arguments.list_signals, "list what can be written, and end");
    simulate_verb->add_option("--csv", simulate_arguments.csv, "write a table: time_s first, one header row");
    simulate_verb->add_option("--comtrade", simulate_arguments.comtrade,
                              "write NAME.cfg and NAME.dat (IEEE C37.111-2013, float32)");
    simulate_verb->add_option("--every", simulate_arguments.every, "write every n-th step")->check(CLI::PositiveNumber);
    simulate_verb->add_flag("--timing", simulate_arguments.timing, "print wall time per step and the real-time factor");
    simulate_verb->add_flag("--quiet", simulate_arguments.quiet, "print nothing but errors");
    simulate_verb->callback([&] { action = [&] { return simulate(simulate_arguments); }; });

    CompareArguments compare_arguments;
    CLI::App* compare_verb = verb("compare", "compare the recordings of two runs: identical, or the first divergence");
    compare_verb->add_option("RUN_A", compare_arguments.a, "run folder or recording")->required();
    compare_verb->add_option("RUN_B", compare_arguments.b, "run folder or recording")->required();
    compare_verb->add_option("--tolerance", compare_arguments.tolerance, "of numbers, absolute or relative")
        ->check(CLI::NonNegativeNumber);
    compare_verb->add_option("--signals", compare_arguments.signals, "compare only these recorded signals (patterns)")
        ->delimiter(',');
    compare_verb->callback([&] { action = [&] { return compare(compare_arguments); }; });

    std::filesystem::path report_run;
    bool report_json = false;
    CLI::App* report_verb = verb("report", "judge a recorded run again and rewrite its report");
    report_verb->add_option("RUN", report_run, "run folder, or latest")->required();
    report_verb->add_flag("--json", report_json, "the summary as JSON");
    report_verb->callback([&] { action = [&] { return report(report_run, report_json); }; });

    std::filesystem::path info_run;
    bool info_json = false;
    CLI::App* info_verb = verb("info", "what a run folder holds");
    info_verb->add_option("RUN", info_run, "run folder, its data.mcap, or latest")->required();
    info_verb->add_flag("--json", info_json, "as JSON");
    info_verb->callback([&] { action = [&] { return info(info_run, info_json); }; });

    ExportArguments export_arguments;
    CLI::App* export_verb = verb("export", "write a recording as tables, or as disturbance records");
    export_verb->add_option("RUN", export_arguments.run, "run folder, or latest")->required();
    export_verb->add_flag("--csv", export_arguments.csv, "CSV: one table per topic (the default)");
    export_verb->add_flag("--comtrade", export_arguments.comtrade,
                          "COMTRADE (IEEE C37.111-2013), ASCII and BINARY, around each trigger");
    export_verb->add_option(
        "--trigger", export_arguments.trigger,
        "COMTRADE: relay2.trip, a signal that rises, or an event (default: record.comtrade of the scenario)");
    export_verb->add_option("--before-ms", export_arguments.before_ms, "COMTRADE: begin before the trigger")
        ->check(CLI::Range(0.0, 60000.0));
    export_verb->add_option("--after-ms", export_arguments.after_ms, "COMTRADE: end after the trigger")
        ->check(CLI::Range(0.001, 60000.0));
    export_verb->add_option("--signals", export_arguments.signals, "COMTRADE: further analog channels (patterns)")
        ->delimiter(',');
    export_verb->add_option("--out", export_arguments.out, "folder (default: RUN/csv, RUN/comtrade)");
    export_verb->callback([&] { action = [&] { return export_run(export_arguments); }; });

    IdsTrainArguments ids_train_arguments;
    IdsEvaluateArguments ids_evaluate_arguments;
    IdsStudyArguments ids_study_arguments;
    add_ids_verbs(app, action, ids_train_arguments, ids_evaluate_arguments, ids_study_arguments);

    MonitorArguments monitor_arguments;
    CLI::App* monitor_verb = verb("monitor", "look at a finished run, or at any DDS domain, in the dashboard");
    CLI::Option* const monitored_run =
        monitor_verb->add_option("RUN", monitor_arguments.run, "run folder (default: latest)");
    CLI::Option* const domain =
        monitor_verb
            ->add_option("--domain", monitor_arguments.domain, "a DDS domain instead of a run: whoever talks there")
            ->check(CLI::Range(0, 232))
            ->excludes(monitored_run);
    monitor_verb
        ->add_option("--address", monitor_arguments.addresses,
                     "address of this machine at which it joins the domain (default: 127.0.0.1; may be repeated)")
        ->check(CLI::ValidIPV4)
        ->allow_extra_args(false)
        ->needs(domain);
    monitor_verb->add_option(
        "--bind,--listen", monitor_arguments.listen,
        "address and port (port 0: a free one); elsewhere than 127.0.0.1 only with a token and TLS");
    monitor_verb->add_option("--token-file", monitor_arguments.token_file,
                             "file with the secret of whoever may look (mode 0600)");
    CLI::Option* certificate = monitor_verb->add_option("--tls-cert", monitor_arguments.tls_cert, "certificate (PEM)");
    monitor_verb->add_option("--tls-key", monitor_arguments.tls_key, "its key (PEM)")->needs(certificate);
    monitor_verb->add_option("--idl", monitor_arguments.idl, "IDL of foreign types")->check(CLI::ExistingFile);
    monitor_verb->callback([&] { action = [&] { return monitor(monitor_arguments); }; });

    RouterArguments router_arguments;
    CLI::App* router_verb = verb("router", "carry topics between DDS domains and sites");
    router_verb->add_option("CONFIG", router_arguments.config, "ends and the topics that may pass (YAML)")->required();
    router_verb->add_flag("--check", router_arguments.check, "check the configuration and end");
    router_verb->add_flag("--json", router_arguments.json, "what happens, as JSON lines on standard output");
    router_verb->callback([&] { action = [&] { return router(router_arguments); }; });

    GraphArguments graph_arguments;
    bool graph_dot = false, graph_json = false, graph_svg = false;
    CLI::App* graph_verb = verb("graph", "who talks to whom in a running scenario");
    graph_verb->add_option("RUN", graph_arguments.run, "run folder, or address of a monitor (default: latest)");
    CLI::Option* as_dot = graph_verb->add_flag("--dot", graph_dot, "for Graphviz");
    CLI::Option* as_json = graph_verb->add_flag("--json", graph_json, "everything, as JSON")->excludes(as_dot);
    graph_verb->add_flag("--svg", graph_svg, "as a picture")->excludes(as_dot)->excludes(as_json);
    graph_verb->add_flag("--framework", graph_arguments.framework, "with the topics of the framework itself");
    graph_verb->callback([&] {
        graph_arguments.format = graph_dot ? "dot" : graph_json ? "json" : graph_svg ? "svg" : "text";
        action = [&] { return graph(graph_arguments); };
    });

    TopicArguments topic_arguments;
    CLI::App* topic_verb = verb("topic", "look at the topics of a running scenario");
    topic_verb->require_subcommand(1);
    auto const topic_command = [&](char const* name, char const* description, bool one,
                                   int (*act)(TopicArguments const&)) {
        CLI::App* command = topic_verb->add_subcommand(name, description);
        if (one) {
            command->add_option("TOPIC", topic_arguments.topic, "its name")->required();
        } else {
            command->add_flag("--framework", topic_arguments.framework, "with the topics of the framework itself");
        }
        command->add_option("--run", topic_arguments.run, "run folder, or address of a monitor (default: latest)");
        command->add_flag("--json", topic_arguments.json, "as JSON");
        if (act == topic_echo) {
            command->add_option("--idl", topic_arguments.idl, "IDL of its type, when nobody publishes it")
                ->check(CLI::ExistingFile);
        }
        command->callback(
            [&action, &topic_arguments, act] { action = [&topic_arguments, act] { return act(topic_arguments); }; });
    };
    topic_command("list", "all topics, with rates", false, topic_list);
    topic_command("info", "its type, readers and writers, IDL", true, topic_info);
    topic_command("echo", "its newest samples, decoded", true, topic_echo);
    topic_command("hz", "how often it is written", true, topic_hz);

    ControlArguments control_arguments;
    auto const control_verb = [&](char const* name, char const* description) {
        CLI::App* command = verb(name, description);
        command->add_option("RUN", control_arguments.run, "run folder (default: latest), started with --allow-control");
        command->callback([&, name] {
            control_arguments.action = name;
            action = [&] { return control(control_arguments); };
        });
        return command;
    };
    control_verb("pause", "let a lockstep run wait after its present tick");
    control_verb("continue", "let a paused run go on");
    control_verb("step", "let a paused run go on for some ticks")
        ->add_option("--ticks", control_arguments.ticks, "how many")
        ->check(CLI::PositiveNumber);
    control_verb("stop", "end a run");

    bool doctor_json = false;
    CLI::App* doctor_verb = verb("doctor", "look at what this machine allows, and what helps");
    doctor_verb->add_flag("--json", doctor_json, "as JSON");
    doctor_verb->callback([&] { action = [&] { return doctor(doctor_json); }; });

    add_bundle_verb(app, action);
    add_play_verb(app, action);
    add_wire_verbs(app, action);
    add_scl_verbs(app, action);
    std::filesystem::path schema_root;
    CLI::App* schema_verb = verb("schema", "write the JSON schemas and the reference page of the configuration files");
    schema_verb->add_option("--write", schema_root, "root of the source tree")->required();
    schema_verb->group(""); // for developers
    schema_verb->callback([&] { action = [&] { return schema(schema_root); }; });

    std::string shell;
    CLI::App* completion_verb = verb("completion", "print a completion script");
    completion_verb->add_option("SHELL", shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    completion_verb->callback([&] {
        action = [&] {
            fmt::print("{}", completion_script(shell, verbs_of(app)));
            return 0;
        };
    });

    app.failure_message(mistake);
    try {
        app.parse(argc, argv);
    } catch (CLI::ParseError const& e) {
        return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    if (show_version) {
        return version(version_json);
    }
    if (!action) {
        fmt::print(stderr, "{}", app.help());
        return static_cast<int>(ExitCode::usage);
    }
    return action();
}

/// `2>&-`: what is opened first must not get the number of a standard stream, and its prints with it. Where there is no
/// standard output, printing is to fail.
void open_standard_descriptors() {
    for (int const fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(fd, F_GETFD) < 0) {
            (void)::open("/dev/null", fd == STDOUT_FILENO ? O_RDONLY : O_RDWR); // gets the lowest number that is free
        }
    }
}

/// What was printed must have arrived: a full disk is no success.
int check_output(int code) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) {
        return code;
    }
    say(stderr, "error: standard output cannot be written{}{}\n", errno == 0 ? "" : ": ",
        errno == 0 ? "" : std::strerror(errno));
    return code == 0 ? static_cast<int>(ExitCode::environment) : code;
}

} // namespace
} // namespace gridspace::cli

int main(int argc, char** argv) {
    gridspace::cli::open_standard_descriptors();
    int code = static_cast<int>(gridspace::ExitCode::environment);
    try {
        code = gridspace::cli::main_function(argc, argv);
    } catch (std::exception const& e) {
        gridspace::say(stderr, "error: {}\n", e.what());
    }
    return gridspace::cli::check_output(code);
}
