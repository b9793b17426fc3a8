// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/command_line/command.hpp"

#include "common/exit_code.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace gridspace::command_line {

Check::Check(std::function<std::string(std::string const&)> complaint)
    : it_{std::make_shared<CLI::Validator>(
          [complaint = std::move(complaint)](std::string& text) { return complaint(text); }, "")} {}
Check::Check(std::shared_ptr<CLI::Validator> it) : it_{std::move(it)} {}

Check in_range(int least, int most) {
    return Check{std::make_shared<CLI::Range>(least, most)};
}
Check in_range(double least, double most) {
    return Check{std::make_shared<CLI::Validator>( // CLI::Range takes nan
        [least, most](std::string& text) {
            double value = 0;
            bool const good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? std::string{} : fmt::format("Value {} not in range [{:g} - {:g}]", text, least, most);
        },
        fmt::format("FLOAT in [{:g} - {:g}]", least, most))};
}
Check one_of(std::vector<std::string> const& words) {
    return Check{std::make_shared<CLI::IsMember>(words)};
}
Check existing_file() {
    return Check{std::make_shared<CLI::Validator>(CLI::ExistingFile)};
}
Check ipv4_address() {
    return Check{std::make_shared<CLI::Validator>(CLI::ValidIPV4)};
}

Option Option::required() {
    it_->required();
    return *this;
}
Option Option::check(Check const& by) {
    it_->check(*by.it_);
    return *this;
}
Option Option::group(std::string const& title) {
    it_->group(title);
    return *this;
}
Option Option::needs(Option other) {
    it_->needs(other.it_);
    return *this;
}
Option Option::needs(std::string const& name) {
    it_->needs(name);
    return *this;
}
Option Option::excludes(Option other) {
    it_->excludes(other.it_);
    return *this;
}
Option Option::delimiter(char between) {
    it_->delimiter(between);
    return *this;
}
Option Option::repeated() {
    it_->take_all()->allow_extra_args(false);
    return *this;
}
Option Option::default_value(std::string const& text) {
    it_->default_str(text)->default_val(text);
    return *this;
}
Option Option::at_once() {
    it_->trigger_on_parse();
    return *this;
}

Command Command::add_subcommand(std::string const& name, std::string const& description) const {
    return Command{*it_->add_subcommand(name, description)};
}
void Command::hide() const {
    it_->group("");
}
void Command::require_subcommand() const {
    it_->require_subcommand(1);
}

template <class T>
Option Command::add_option(std::string const& names, T& value, std::string const& description) const {
    return Option{*it_->add_option(names, value, description)};
}
Option Command::add_flag(std::string const& names, bool& value, std::string const& description) const {
    return Option{*it_->add_flag(names, value, description)};
}
Option Command::add_flag(std::string const& names, std::function<void()> act, std::string const& description) const {
    return Option{*it_->add_flag_callback(names, std::move(act), description)};
}

void Command::callback(std::function<void()> act) const {
    it_->callback(std::move(act));
}
void Command::final_callback(std::function<void()> act) const {
    it_->final_callback(std::move(act));
}
void Command::require(std::function<std::string(Command)> complaint) const {
    it_->parse_complete_callback([self = *this, complaint = std::move(complaint)] {
        if (std::string const missing = complaint(self); !missing.empty()) {
            throw CLI::RequiredError(missing);
        }
    });
}
bool Command::has(std::string const& option) const {
    return it_->count(option) > 0;
}

void end_reading() {
    throw CLI::Success{};
}

Program::Program(std::string const& name, std::string const& description, std::string const& version)
    : app_{std::make_unique<CLI::App>(description, name)} {
    app_->set_version_flag("--version", version);
}
Program::~Program() = default;

std::optional<int> Program::parse(int argc, char** argv) {
    try {
        app_->parse(argc, argv);
    } catch (CLI::ParseError const& e) {
        return app_->exit(e) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    return std::nullopt;
}

template Option Command::add_option(std::string const&, std::string&, std::string const&) const;
template Option Command::add_option(std::string const&, std::filesystem::path&, std::string const&) const;
template Option Command::add_option(std::string const&, int&, std::string const&) const;
template Option Command::add_option(std::string const&, std::int64_t&, std::string const&) const;
template Option Command::add_option(std::string const&, std::uint64_t&, std::string const&) const;
template Option Command::add_option(std::string const&, unsigned int&, std::string const&) const;
template Option Command::add_option(std::string const&, double&, std::string const&) const;
template Option Command::add_option(std::string const&, std::vector<std::string>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::vector<std::filesystem::path>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::optional<std::string>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::optional<int>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::optional<std::int64_t>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::optional<double>&, std::string const&) const;
template Option Command::add_option(std::string const&, std::vector<int>&, std::string const&) const;

} // namespace gridspace::command_line
