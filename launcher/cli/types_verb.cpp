// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/exit_code.hpp"
#include "common/idl/c_header.hpp"
#include "common/text.hpp"
#include "idl/idl_texts.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/say.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>

namespace gridspace::cli {
namespace {

/// All structs of a text of IDL. Nothing, or why not.
Result<void> add_all(idl::CHeader& header, std::string_view text) {
    auto parsed = idl::parse(text);
    if (!parsed) {
        return std::unexpected{parsed.error()};
    }
    auto const model = std::make_shared<idl::Model const>(std::move(*parsed));
    for (idl::Type const& type : model->types) {
        if (type.kind == idl::Kind::structure) {
            auto const layout = idl::NativeLayout::create(model, type.name);
            if (!layout) {
                return std::unexpected{layout.error()};
            }
            header.add(*layout);
        }
    }
    return {};
}

int types(std::vector<std::filesystem::path> const& files) {
    idl::CHeader header;
    std::vector<std::string> words{"gridspace types"};
    if (files.empty()) {
        for (IdlText const& ours : idl_texts()) {
            if (auto const ok = add_all(header, ours.text); !ok) {
                say(stderr, "error: {}: {}\n", ours.file, describe(ok.error()));
                return static_cast<int>(ok.error().code);
            }
        }
    }
    for (std::filesystem::path const& file : files) {
        words.push_back(file.filename().string());
        std::ifstream in{file};
        std::string const text{std::istreambuf_iterator<char>{in}, {}};
        if (!in.is_open()) {
            say(stderr, "error: cannot read '{}'\n  expected a file of IDL\n", file.string());
            return static_cast<int>(ExitCode::usage);
        }
        if (auto const ok = add_all(header, text); !ok) {
            say(stderr, "error: {}: {}\n", file.string(), describe(ok.error()));
            return static_cast<int>(ok.error().code);
        }
    }
    fmt::print("{}", header.text(fmt::format("Made by `{}`.", join(words, " "))));
    return 0;
}

} // namespace

void add_types(Command app, Action& action) {
    auto const files = std::make_shared<std::vector<std::filesystem::path>>();
    Command verb = app.add_subcommand("types", "print structs of C for types of IDL: for agents in C and C++");
    verb.add_option("FILE", *files, "IDL files of your own types; without one the types of Gridspace");
    verb.callback([files, &action] { action = [files] { return types(*files); }; });
}

} // namespace gridspace::cli
