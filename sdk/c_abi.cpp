// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of gridspace/agent.h. No exception leaves them.
#include "bus/daemon.hpp"
#include "common/log.hpp"
#include "common/version.hpp"
#include "sdk/agent_member.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <span>
#include <string_view>
#include <thread>

using namespace gridspace;

namespace {

thread_local std::string last_error;

void note(std::string text) {
    last_error = std::move(text);
}

/// What `body` returns, or `failed` when it throws.
template <class Body, class Value>
Value guarded(Value failed, Body const& body) noexcept {
    try {
        return body();
    } catch (std::exception const& e) {
        note(e.what());
    } catch (...) {
        note("an unknown exception");
    }
    return failed;
}

/// What a function of C returns; why it failed is kept, for who asks and for the end of the run.
int code_of(gridspace_agent& agent, Result<int> const& result) {
    if (!result) {
        note(describe(result.error()));
        agent.refused(last_error);
        return -1;
    }
    return *result;
}

int code_of(gridspace_agent& agent, Result<void> const& result) {
    return code_of(agent, result ? Result<int>{0} : Result<int>{std::unexpected{result.error()}});
}

/// Of gridspace_main: callbacks come on it.
std::thread::id agent_thread;

/// The same of a function that only callbacks may call; on another thread it does nothing.
template <class Body>
int in_callback(gridspace_agent& agent, Body const& body) noexcept {
    return guarded(-1, [&] {
        if (std::this_thread::get_id() != agent_thread) {
            note("called on another thread than the one that calls the agent; hand it over, and call it in a callback, "
                 "of a timer for example");
            return -1;
        }
        return code_of(agent, body());
    });
}

int number_or_note(std::optional<int> number, char const* what, char const* name) {
    if (!number) {
        note(fmt::format("the description names no {} '{}'", what, name));
    }
    return number.value_or(-1);
}

/// The program as its description says, or nothing, with the mistakes printed.
std::optional<sdk::DescribedProgram> read_program(gridspace_program const& given, char const* own_name) {
    sdk::DescribedProgram out;
    out.callbacks = given;
    std::string const text = given.description == nullptr ? "" : given.description;
    config::Diagnostics diagnostics;
    auto declaration = program::from_json(text, "its description", diagnostics);
    if (!declaration) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return std::nullopt;
    }
    out.declaration = std::move(*declaration);
    out.folder =
        given.folder != nullptr ? std::filesystem::path{given.folder} : std::filesystem::path{own_name}.parent_path();
    return out;
}

int run_program(gridspace_program const& given, int argc, char** argv) {
    std::span const words{argv, static_cast<std::size_t>(argc)};
    auto const program = read_program(given, words.empty() ? "" : words.front());
    if (!program && std::find(words.begin(), words.end(), std::string_view{"--describe"}) != words.end()) {
        fmt::print("{}\n", given.description == nullptr ? "" : given.description); // who asks says where it is wrong
        return 0;
    }
    if (!program) {
        return static_cast<int>(ExitCode::usage);
    }
    config::Node settings = config::Node::map();
    auto const& keys = program->declaration.settings;
    gateways::WireConfig wire;
    auto const uses_streams = [](std::vector<program::Topic> const& topics) {
        return std::any_of(topics.begin(), topics.end(), [](program::Topic const& t) { return t.is_stream; });
    };
    bool const has_wire = uses_streams(program->declaration.reads) || uses_streams(program->declaration.writes);
    Daemon const daemon{.program = program->declaration.name,
                        .description = program->declaration.description,
                        .describe_settings =
                            [&](config::Fields& f) {
                                config::read_keys(f, keys);
                                for (config::Key const& key : keys) {
                                    if (f.has(key.key)) {
                                        f.raw(key.key, settings.set(key.key, {}));
                                    }
                                }
                                if (has_wire) {
                                    gateways::describe_wire(f, wire);
                                }
                            },
                        .check = {},
                        .run =
                            [&](DaemonRun& run) {
                                return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                    gridspace_agent agent{*program, settings, wire, node};
                                    auto const ok = bus::run_member(node, agent);
                                    return ok ? agent.outcome() : ok;
                                });
                            },
                        .declaration = [&] { return program->declaration; },
                        .is_ours = false};
    return run_daemon(daemon, argc, argv);
}

} // namespace

int gridspace_main(gridspace_program const* program, int argc, char** argv) {
    constexpr std::size_t kFirstSize = offsetof(gridspace_program, end) + sizeof(gridspace_program::end);
    if (program == nullptr || program->size < kFirstSize) {
        std::fputs("gridspace_main: gridspace_program.size is not sizeof(gridspace_program)\n", stderr);
        return static_cast<int>(ExitCode::usage);
    }
    agent_thread = std::this_thread::get_id();
    int const code = guarded(-1, [&] { return run_program(*program, argc, argv); });
    if (code < 0) {
        std::fprintf(stderr, "gridspace_main: %s\n", last_error.c_str());
        return static_cast<int>(ExitCode::environment);
    }
    return code;
}

unsigned gridspace_abi_version(void) {
    return GRIDSPACE_ABI_VERSION;
}

char const* gridspace_version(void) {
    return guarded("", [] {
        static std::string const text{version().version};
        return text.c_str();
    });
}

char const* gridspace_last_error(void) {
    return last_error.c_str();
}

int64_t gridspace_now_ns(gridspace_agent const* agent) {
    return agent->node().time_base().nanoseconds(agent->now());
}

double gridspace_now_s(gridspace_agent const* agent) {
    return agent->node().time_base().seconds(agent->now());
}

int64_t gridspace_effect_ns(gridspace_agent const* agent) {
    return agent->node().time_base().nanoseconds(agent->effect_time());
}

int gridspace_is_lockstep(gridspace_agent const* agent) {
    return agent->node().lockstep() ? 1 : 0;
}

char const* gridspace_process(gridspace_agent const* agent) {
    return agent->node().config().process.c_str();
}

int gridspace_every(gridspace_agent* agent, char const* period_s) {
    return in_callback(*agent, [&] { return agent->every(period_s); });
}

int gridspace_at(gridspace_agent* agent, int64_t time_ns) {
    return in_callback(*agent, [&] { return agent->at(time_ns); });
}

int gridspace_cancel(gridspace_agent* agent, int timer) {
    return in_callback(*agent, [&] { return agent->cancel(timer); });
}

char const* gridspace_setting(gridspace_agent const* agent, char const* path) {
    return guarded(static_cast<char const*>(nullptr), [&]() -> char const* {
        std::string const* const text = agent->setting(path);
        if (text == nullptr) {
            note(fmt::format("the setting '{}' is not given", path));
            return nullptr;
        }
        return text->c_str();
    });
}

int gridspace_number(gridspace_agent const* agent, char const* path, double* value) {
    return guarded(-1, [&] {
        std::string const* const text = agent->setting(path);
        auto const number = text == nullptr ? std::nullopt : config::number_of(config::Node::scalar(*text));
        if (!number) {
            note(text == nullptr ? fmt::format("the setting '{}' is not given", path)
                                 : fmt::format("the setting '{}' is '{}', which is no number", path, *text));
            return -1;
        }
        *value = *number;
        return 0;
    });
}

char const* gridspace_settings(gridspace_agent const* agent) {
    return agent->settings_json().c_str();
}

char const* gridspace_topics(gridspace_agent const* agent) {
    return agent->topics_json().c_str();
}

int gridspace_reader(gridspace_agent const* agent, char const* topic) {
    return guarded(-1, [&] { return number_or_note(agent->reader(topic), "topic that it reads", topic); });
}

int gridspace_writer(gridspace_agent const* agent, char const* topic) {
    return guarded(-1, [&] { return number_or_note(agent->writer(topic), "topic that it writes", topic); });
}

int gridspace_write(gridspace_agent* agent, int writer, void const* sample, size_t size) {
    return in_callback(*agent, [&] { return agent->write(writer, sample, size); });
}

void gridspace_keep(void const* sample) {
    sdk::SampleBlock::of(sample)->keep();
}

void gridspace_release(void const* sample) {
    sdk::SampleBlock::of(sample)->release();
}

char const* gridspace_layout(char const* type, char const* idl_file) {
    return guarded(static_cast<char const*>(nullptr), [&]() -> char const* {
        static std::mutex mutex;
        static std::map<std::pair<std::string, std::string>, std::string> known;
        std::lock_guard const lock{mutex};
        auto const [entry, is_new] = known.try_emplace({type, idl_file == nullptr ? "" : idl_file});
        if (is_new) {
            auto const loaded = sdk::TopicType::load(entry->first.first, entry->first.second);
            if (!loaded) {
                note(describe(loaded.error()));
                known.erase(entry);
                return nullptr;
            }
            entry->second = (*loaded)->layout_json();
        }
        return entry->second.c_str();
    });
}

int gridspace_signal(gridspace_agent* agent, int signal, double value) {
    return in_callback(*agent, [&] { return agent->signal(signal, value); });
}

int gridspace_signal_number(gridspace_agent const* agent, char const* name) {
    return guarded(-1, [&] { return number_or_note(agent->signal_number(name), "signal", name); });
}

int gridspace_declared_signal(gridspace_agent const* agent, char const* declared, char const* value) {
    return guarded(-1, [&] {
        auto const found =
            agent->declared_signal(declared, value == nullptr ? std::nullopt : std::optional<std::string_view>{value});
        if (!found) {
            note(describe(found.error()));
        }
        return found.value_or(-1);
    });
}

void gridspace_log(int level, char const* text) {
    constexpr std::array kLevels{log::Level::debug, log::Level::info, log::Level::warning, log::Level::error};
    (void)guarded(0, [&] {
        auto const known = kLevels.at(static_cast<std::size_t>(level < 0 || level > 3 ? 1 : level));
        if (log::enabled(known)) {
            log::write(known, text);
        }
        return 0;
    });
}

int gridspace_fail(gridspace_agent* agent, char const* message, char const* remedy) {
    return guarded(-1, [&] {
        agent->fail_with(
            {ExitCode::child_died, message == nullptr ? "it failed" : message, remedy == nullptr ? "" : remedy});
        return -1;
    });
}
