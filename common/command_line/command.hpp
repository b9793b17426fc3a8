// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class App;
class Option;
class Validator;
} // namespace CLI

/// The part of CLI11 that our programs use, by its names. CLI11 is all headers: a source with it is compiled seven
/// seconds longer, so command.cpp does it for all.
namespace gridspace::command_line {

/// Judges what is written for an option, before anything runs.
class Check {
  public:
    /// `complaint` returns what is wrong with a text, or nothing.
    explicit Check(std::function<std::string(std::string const&)> complaint);
    explicit Check(std::shared_ptr<CLI::Validator> it);

  private:
    friend class Option;
    std::shared_ptr<CLI::Validator> it_;
};
[[nodiscard]] Check in_range(int least, int most);
[[nodiscard]] Check in_range(double least, double most);
[[nodiscard]] Check one_of(std::vector<std::string> const& words);
[[nodiscard]] Check existing_file();
[[nodiscard]] Check ipv4_address();

/// An option of a command: a handle, valid as long as the program's command line.
class Option {
  public:
    explicit Option(CLI::Option& it) : it_{&it} {}

    Option required();
    Option check(Check const& by);
    Option group(std::string const& title);
    Option needs(Option other);
    Option needs(std::string const& name);
    Option excludes(Option other);
    Option delimiter(char between); ///< "a,b,c": several values in one word
    Option repeated();              ///< may be given several times, with one value each
    Option default_value(std::string const& text);
    Option at_once(); ///< acts when it is read, whatever else is missing

  private:
    CLI::Option* it_;
};

/// A command or verb: a handle, valid as long as the program's command line.
class Command {
  public:
    explicit Command(CLI::App& it) : it_{&it} {}

    Command add_subcommand(std::string const& name, std::string const& description) const;
    void require_subcommand() const;
    void hide() const; ///< from the help: for scripts and developers

    /// For texts, paths, numbers, and vectors and optionals of them: the list is at the end of command.cpp.
    template <class T>
    Option add_option(std::string const& names, T& value, std::string const& description) const;
    Option add_flag(std::string const& names, bool& value, std::string const& description) const;
    Option add_flag(std::string const& names, std::function<void()> act, std::string const& description) const;

    /// When the command is given and complete; with subcommands of its own, the last one to act counts.
    void callback(std::function<void()> act) const;
    void final_callback(std::function<void()> act) const;
    /// When all of the command's own options have been read; `complaint` returns what is missing, or nothing.
    void require(std::function<std::string(Command)> complaint) const;

    [[nodiscard]] bool has(std::string const& option) const; ///< was given
    [[nodiscard]] CLI::App& library() const { return *it_; } ///< for who includes CLI11: help, completion

  private:
    CLI::App* it_;
};

/// Ends the reading of a command line with success: for a flag that prints something and is all.
[[noreturn]] void end_reading();

/// The command line of a program with options alone.
class Program {
  public:
    Program(std::string const& name, std::string const& description, std::string const& version);
    ~Program();
    Program(Program const&) = delete;
    Program& operator=(Program const&) = delete;

    [[nodiscard]] Command command() const { return Command{*app_}; }
    /// The exit code when the program shall end here (--help: 0, a mistake: 2), nothing otherwise.
    [[nodiscard]] std::optional<int> parse(int argc, char** argv);

  private:
    std::unique_ptr<CLI::App> app_;
};

} // namespace gridspace::command_line
