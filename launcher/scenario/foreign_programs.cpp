// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/foreign_programs.hpp"

#include "common/text.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/limited_command.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

/// How long a program has to say what it is: on a busy machine a Python takes seconds to start.
std::chrono::seconds patience() {
    char const* const given = std::getenv("GRIDSPACE_DESCRIBE_TIMEOUT_S");
    long const seconds = given == nullptr ? 0 : std::strtol(given, nullptr, 10);
    return std::chrono::seconds{seconds > 0 ? seconds : 30};
}

/// The last line, and of a traceback of Python the place as well: "SyntaxError: invalid syntax (agent.py:12)".
std::string last_words(std::string_view errors) {
    std::string_view const all = trim(errors);
    std::string out{all.substr(all.rfind('\n') + 1)}; // npos + 1 is 0
    constexpr std::string_view kFile = "File \"", kLine = "\", line ";
    std::size_t const file = all.rfind(kFile), line = all.find(kLine, std::min(file, all.size()));
    if (line != std::string_view::npos) {
        std::string_view const path = all.substr(file + kFile.size(), line - file - kFile.size());
        std::string_view const number = all.substr(line + kLine.size());
        out += fmt::format(" ({}:{})", path.substr(path.rfind('/') + 1),
                           number.substr(0, number.find_first_not_of("0123456789")));
    }
    return out;
}

/// What the program says when it is asked.
std::optional<program::Declaration> ask_program(std::vector<std::string> const& command, Ref const& where,
                                                Diagnostics& diagnostics) {
    std::vector<std::string> words = command;
    words.emplace_back("--describe");
    auto const refuse = [&](std::string const& what, std::string hint) {
        diagnostics.error(where.where, fmt::format("'{}' does not say what it is: {}", join(words, " "), what),
                          std::move(hint), static_cast<int>(where.name.size()));
        return std::nullopt;
    };
    auto const said = run_limited(words, patience(), {});
    if (!said) {
        return refuse(said.error().message, said.error().remedy);
    }
    std::string const hint =
        "it has to print its description as JSON and end with 0: docs/reference/program_description.md";
    if (said->too_long) {
        return refuse(fmt::format("it printed more than {} octets", kMaxCommandOutput), hint);
    }
    if (said->timed_out) {
        return refuse(fmt::format("no answer within {} s", patience().count()), hint);
    }
    if (said->code != 0) {
        std::string const last = last_words(said->errors);
        return refuse(fmt::format("it ended with code {}{}{}", said->code, last.empty() ? "" : ": ", last), hint);
    }
    if (trim(said->output).empty()) {
        return refuse("it printed nothing", hint);
    }
    return program::from_json(said->output, join(words, " "), diagnostics);
}

} // namespace

std::optional<program::Declaration> const& ForeignPrograms::ask(std::vector<std::string> const& command,
                                                                Ref const& path, Diagnostics& diagnostics) {
    auto const [known, is_new] = answers_.try_emplace(command);
    if (is_new && may_start_) {
        known->second = ask_program(command, path, diagnostics);
    } else if (is_new) {
        diagnostics.error(path.where, "no program of somebody else is started here");
    }
    return known->second;
}

std::unique_ptr<ProcessSettings> ForeignPrograms::read(config::Fields& fields, Node const& written, std::string& name,
                                                       Diagnostics& diagnostics) {
    Ref path;
    std::vector<Ref> arguments;
    fields.object("program", {}, [&](config::Fields& f) {
        std::filesystem::path file;
        f.file("path", file, {.doc = "a program of your own that says what it is", .required = true});
        path = {file.empty() ? "" : std::filesystem::absolute(file).lexically_normal().string(), f.where("path")};
        f.references("arguments", arguments, {.doc = "words before its options", .may_be_empty = true});
    });
    std::optional<program::Declaration> declaration;
    std::vector<std::string> command{path.name};
    for (Ref& word : arguments) {
        command.push_back(std::move(word.name));
    }
    if (!path.empty()) {
        declaration = ask(command, path, diagnostics);
    }
    if (!declaration) {
        Node ignored;
        for (Node::Entry const& entry : written.entries) {
            fields.raw(entry.key, ignored); // its own keys cannot be judged
        }
        return nullptr;
    }
    name = declaration->name;
    config::read_keys(fields, declaration->settings);
    return std::make_unique<DeclaredSettings>(std::move(*declaration), std::move(command));
}

} // namespace gridspace::launcher
