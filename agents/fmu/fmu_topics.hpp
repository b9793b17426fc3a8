// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/fmu/fmu_table.hpp"
#include "bus/node.hpp"
#include "bus/signal_publisher.hpp"
#include "gateways/mapping/record_reader.hpp"
#include "gateways/mapping/record_writer.hpp"

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gridspace::agents {

/// The topics and signals of an FMU agent: samples in, values of variables out, and the other way round.
class FmuTopics {
  public:
    /// All arguments must outlive it.
    [[nodiscard]] static Result<std::unique_ptr<FmuTopics>>
    open(bus::Node& node, FmuConfig const& config, FmuTable& table, fmi::ModelDescription const& description);

    void announce(SimTime now);
    struct Arrival {
        bus::Origin origin;
        std::size_t reader{0};
        std::vector<std::byte> cdr;
    };
    /// What is due now, in an order that does not depend on the network.
    [[nodiscard]] std::vector<Arrival> arrived();
    using Input = std::function<void(std::size_t variable, fmi::Value value)>;
    /// The inputs that a sample gives.
    void read(Arrival const& arrival, Input const& input);
    /// Each topic that is read has given a sample of `time` or later.
    [[nodiscard]] bool came_after(SimTime time) const;
    /// Samples and signals of a communication point.
    void write(SimTime point, std::span<mapping::Value const> values);
    void flush();

  private:
    struct Reader {
        std::string topic;
        std::shared_ptr<bus::CdrReader> samples;
        std::optional<SimTime> newest;
    };
    struct Fed {
        FmuTable::Input* table;
        std::size_t reader;
        mapping::RecordReader record;
        std::vector<mapping::Value> fields, variables;
    };
    struct Output {
        FmuTable::Output* table;
        bus::CdrWriter* writer;
        mapping::RecordWriter record;
    };
    FmuTopics(bus::Node& node, FmuConfig const& config)
        : node_{node}, latency_{node.time_base().ceil(config.latency_us / Rational{1'000'000})} {}
    [[nodiscard]] Result<void> open_inputs(FmuTable& table);
    [[nodiscard]] Result<void> open_outputs(FmuTable& table);
    [[nodiscard]] Result<void> open_signals(FmuConfig const& config, FmuTable const& table,
                                            fmi::ModelDescription const& description);
    void warn_of_long_texts(FmuTable::Output const& output, std::span<mapping::Value const> fields);

    bus::Node& node_;
    SimSpan latency_;
    std::vector<Reader> readers_;
    std::vector<Fed> inputs_;
    std::map<std::string, std::unique_ptr<bus::CdrWriter>> writers_;
    std::vector<Output> outputs_;
    std::vector<std::size_t> watched_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> row_;
    bool misfit_said_{false}, cut_said_{false};
};

} // namespace gridspace::agents
