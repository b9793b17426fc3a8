// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "common/program/declaration.hpp"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct SignalFrame;
struct SignalCatalog;

namespace gridspace::bus {

struct SignalColumn {
    std::string name; ///< kind.element.quantity[.phase]
    std::string unit;
};

/// Publishes named signals of a process on the topics signal_catalog and signals. Rows are gathered into frames whose
/// size depends on the rate only, so that what is recorded does not depend on tick or pace.
class SignalPublisher {
  public:
    /// `rate_hz` 0: rows come when something changes, and each is sent at once.
    [[nodiscard]] static Result<std::unique_ptr<SignalPublisher>> create(Node& node, std::string group, double rate_hz,
                                                                         std::vector<SignalColumn> columns);
    /// Signals that a program declares, as columns; "{process}" is the node's.
    [[nodiscard]] static std::vector<SignalColumn> columns_of(Node const& node,
                                                              std::vector<program::Signal> const& declared);
    /// The columns are those that a program declares; `values` are of the settings in their names.
    [[nodiscard]] static Result<std::unique_ptr<SignalPublisher>>
    create(Node& node, std::string group, std::vector<program::Signal> const& declared,
           std::map<std::string, std::vector<std::string>, std::less<>> const& values);
    ~SignalPublisher();

    /// After Node::start: publishes the columns.
    void announce(SimTime now);
    /// One row: a value per column.
    void row(SimTime time, std::span<double const> values);
    /// Sends what has been gathered; at the end of a run.
    void flush();

  private:
    SignalPublisher() = default;
    struct Writers; ///< shared by all groups of a process: one writer a topic, whatever it publishes
    Node* node_{nullptr};
    std::shared_ptr<Writers> writers_;
    std::unique_ptr<SignalCatalog> catalog_;
    std::unique_ptr<SignalFrame> frame_;
    std::size_t columns_{0};
    std::size_t rows_per_frame_{1};
    SimTime last_;
};

} // namespace gridspace::bus
