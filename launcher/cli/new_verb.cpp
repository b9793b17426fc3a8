// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Makes a folder of files of `templates/`. In their names NAME, in them @name@, @Name@ and @program@ are filled in.
#include "common/exit_code.hpp"
#include "common/result.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/taken_names.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/say.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/sweep/study_folder.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>

namespace gridspace::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 32; ///< of a process, in messages and on the wire

struct NewArguments {
    std::string name, language;
    fs::path out;
};

/// What stands for what.
using Words = std::vector<std::pair<std::string, std::string>>;

std::string filled(std::string text, Words const& words) {
    for (auto const& [word, meaning] : words) {
        for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + meaning.size())) {
            text.replace(at, word.size(), meaning);
        }
    }
    return text;
}

/// "my_agent" to "MyAgent".
std::string type_name(std::string_view name) {
    std::string out;
    bool upper = true;
    for (char const c : name) {
        if (c == '_') {
            upper = true;
        } else {
            out += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
            upper = false;
        }
    }
    return out;
}

Result<void> check(NewArguments const& a) {
    bool const well_formed = !a.name.empty() && a.name.size() <= kMaxName && a.name.front() >= 'a' &&
                             a.name.front() <= 'z' && std::all_of(a.name.begin(), a.name.end(), [](char c) {
                                 return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                             });
    if (!well_formed) {
        return fail(
            ExitCode::usage, fmt::format("'{}' cannot be the name", a.name),
            fmt::format("small letters, digits and '_', a letter first, at most {}: it becomes the name of files, "
                        "of a process and of a class",
                        kMaxName));
    }
    if (std::find(kTakenNames.begin(), kTakenNames.end(), a.name) != kTakenNames.end()) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be the name: it means something already", a.name),
                    "in Python or CMake, or beside it in its folder");
    }
    std::error_code ignored;
    if (fs::exists(a.out, ignored)) {
        return fail(ExitCode::usage, fmt::format("'{}' is there already", a.out.string()),
                    "another name, or --out FOLDER");
    }
    return {};
}

Result<void> copy_file(fs::path const& from, fs::path const& to, Words const& words) {
    std::ifstream in{from};
    std::string const text{std::istreambuf_iterator<char>{in}, {}};
    std::ofstream out{to};
    out << filled(text, words);
    out.close();
    std::error_code error;
    fs::permissions(to, fs::status(from, error).permissions(), error); // a script may be started
    return in.is_open() && out && !error ? Result<void>{}
                                         : fail(ExitCode::environment, fmt::format("cannot write '{}'", to.string()));
}

Result<void> copy_folder(fs::path const& from, fs::path const& to, std::string const& name, Words const& words) {
    std::error_code error;
    for (fs::directory_entry const& entry : fs::directory_iterator{from, error}) {
        std::string const file = filled(entry.path().stem().string(), {{"NAME", name}}); // without ".in"
        if (auto ok = copy_file(entry.path(), to / file, words); !ok) {
            return ok;
        }
    }
    return error ? fail(ExitCode::environment,
                        fmt::format("cannot read the templates in '{}': {}", from.string(), error.message()))
                 : Result<void>{};
}

Result<void> make_folder(NewArguments const& a, std::vector<std::string> const& parts, bool with_network) {
    if (auto ok = check(a); !ok) {
        return ok;
    }
    std::error_code error;
    fs::create_directories(a.out, error);
    if (error) {
        return fail(ExitCode::environment, fmt::format("cannot make '{}': {}", a.out.string(), error.message()));
    }
    fs::path const templates = launcher::shared_folder("templates");
    Words const words{{"@name@", a.name},
                      {"@Name@", type_name(a.name)},
                      {"@program@", a.language == "python" ? a.name + ".py" : "build/" + a.name}};
    Result<void> ok;
    for (std::string const& part : parts) {
        ok = ok ? copy_folder(templates / part, a.out, a.name, words) : ok;
    }
    if (ok && with_network) {
        ok = copy_file(templates / "network/NAME.yaml.in", a.out / "network.yaml", words);
    }
    if (!ok) {
        fs::remove_all(a.out, error); // made above
    }
    return ok;
}

/// How this program is called here: by its name where PATH leads to it, else by its file.
struct OwnCommand {
    std::string program{launcher::program_file("gridspace").string()}; ///< as a word of the shell
    std::string for_tests;                                             ///< what their commands begin with

    OwnCommand() {
        std::error_code error;
        char const* const path = std::getenv("PATH");
        for (std::string const& folder : split(path == nullptr ? "" : path, ':')) {
            if (fs::equivalent(fs::path{folder} / "gridspace", program, error) && !error) {
                program = "gridspace";
                return;
            }
        }
        for_tests =
            fmt::format("GRIDSPACE_BIN_DIR={} ", launcher::shell_word(fs::path{program}.parent_path().string()));
        program = launcher::shell_word(program);
    }
};

int finish(Result<void> const& made, std::vector<std::string> const& next) {
    if (!made) {
        say(stderr, "error: {}{}{}\n", made.error().message, made.error().remedy.empty() ? "" : "\n  ",
            made.error().remedy);
        return static_cast<int>(made.error().code);
    }
    for (std::string const& command : next) {
        fmt::print("{}\n", command);
    }
    return 0;
}

int agent(NewArguments const& a) {
    auto const made = make_folder(a, {"agent/any", "agent/" + (a.language == "c++" ? "cpp" : a.language)}, true);
    std::string const out = a.out.string(), run = fmt::format("{} run {}/scenario.yaml", OwnCommand{}.program, out);
    if (a.language == "python") {
        return finish(made, {run, fmt::format("PYTHONPATH={} python3 {}/{}_test.py",
                                              launcher::shared_folder("python").string(), out, a.name)});
    }
    return finish(
        made,
        {fmt::format("cmake -S {} -B {}/build -DCMAKE_PREFIX_PATH={}", out, out, launcher::prefix_folder().string()),
         fmt::format("cmake --build {}/build", out), run, fmt::format("ctest --test-dir {}/build", out)});
}

int scenario(NewArguments const& a) {
    OwnCommand const own;
    return finish(make_folder(a, {"scenario"}, true),
                  {fmt::format("{} run {}/{}.yaml", own.program, a.out.string(), a.name),
                   fmt::format("{}python3 {}/{}_test.py", own.for_tests, a.out.string(), a.name)});
}

int network(NewArguments const& a) {
    OwnCommand const own;
    return finish(make_folder(a, {"network"}, false),
                  {fmt::format("{} powerflow {}/{}.yaml", own.program, a.out.string(), a.name),
                   fmt::format("{}python3 {}/{}_test.py", own.for_tests, a.out.string(), a.name)});
}

} // namespace

void add_new(Command app, Action& action) {
    Command verb = app.add_subcommand("new", "make a folder with an agent, a scenario or a network, and a test");
    verb.require_subcommand();
    auto const add = [&](char const* kind, char const* help, int (*make)(NewArguments const&)) {
        auto const a = std::make_shared<NewArguments>();
        Command sub = verb.add_subcommand(kind, help);
        sub.add_option("NAME", a->name, "its name: small letters, digits and '_'").required();
        sub.add_option("--out", a->out, "the folder; must not be there. Default: NAME");
        sub.callback([a, make, &action] {
            action = [a, make] {
                if (a->out.empty()) {
                    a->out = a->name;
                }
                return make(*a);
            };
        });
        return std::pair{sub, a};
    };
    auto const [sub, a] = add("agent", "a program that takes part in a run, with a scenario for it", agent);
    sub.add_option("--language", a->language, "c++, python or c")
        .check(one_of({"c++", "python", "c"}))
        .default_value("python");
    add("scenario", "a scenario with a network", scenario);
    add("network", "a network", network);
}

} // namespace gridspace::cli
