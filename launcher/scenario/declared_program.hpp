// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/program/declaration.hpp"
#include "launcher/scenario/program.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// Settings of a process of a program that has declared what it is. Everything about it follows from the declaration
/// and the settings: what is wrong with them, its topics and signals, its place among the members. One of ours that
/// has more to check, or whose configuration file holds more than its settings, is a class of its own.
class DeclaredSettings : public ProcessSettings {
  public:
    /// `command`: the program and its arguments; empty for one of ours.
    explicit DeclaredSettings(program::Declaration declaration, std::vector<std::string> command = {})
        : declaration_{std::move(declaration)}, command_{std::move(command)} {}

    void check(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) override;
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] bool is_member() const override { return declaration_.member; }
    [[nodiscard]] bool is_expected() const override { return declaration_.member; }
    [[nodiscard]] Rational latency_s(Process const& process) const override;
    [[nodiscard]] Rational promises_s(Process const& process) const override {
        return declaration_.promises_latency ? latency_s(process) : Rational{0};
    }
    [[nodiscard]] bool works_ahead() const override { return declaration_.works_ahead; }
    [[nodiscard]] config::Node settings(Scenario const& scenario, Process const& process) const override;
    [[nodiscard]] std::vector<std::string> command() const override { return command_; }
    [[nodiscard]] bool is_daemon() const override { return command_.empty() || declaration_.daemon; }
    [[nodiscard]] program::Declaration const& declaration() const { return declaration_; }

  protected:
    /// What this process is, as its settings and the scenario have it: no other names than "{process}" are left open.
    void declare(program::Declaration declaration) { declaration_ = std::move(declaration); }
    void check_whole_steps(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) const;

  private:
    program::Declaration declaration_;
    std::vector<std::string> command_;
};

} // namespace gridspace::launcher
