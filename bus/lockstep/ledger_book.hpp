// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::lockstep {

/// Compares what others say they have sent (ledgers) with what has arrived, per process and topic. Pure bookkeeping: no
/// DDS, no clock, no allocation after the constructor's names are known. A restarted process counts from 0 again.
class LedgerBook {
  public:
    /// `processes`: everybody whose samples count; `readers`: the topic of each reader of this process (several may
    /// read one).
    LedgerBook(std::vector<std::string> processes, std::vector<std::string> readers);

    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    [[nodiscard]] std::size_t process_index(std::string_view process) const; ///< kUnknown when not of the run
    [[nodiscard]] std::string const& process_name(std::size_t process) const { return processes_[process].name; }
    [[nodiscard]] std::size_t process_count() const { return processes_.size(); }

    /// One ledger line: `process` has sent `sent` samples on `topic` since its incarnation started. Topics that are not
    /// read here do not matter.
    void announced(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent);

    /// For a process that joins a running simulation: what was sent before it was ready counts as held.
    void baseline(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent);

    /// `process` has done all work up to `time_quanta`, and its ledger was taken: what it sends from now on is of a
    /// later time. Says which of its samples were not in the ledger; empty when none.
    [[nodiscard]] std::string acknowledged(std::size_t process, std::uint32_t incarnation, std::int64_t time_quanta);

    enum class Arrival {
        expected,
        repeated, ///< seen before, or of an incarnation that is gone: to be dropped
        gap,      ///< samples before this one are lost for good
        late,     ///< of a time that its process has acknowledged, and not in that ledger: written afterwards
    };
    /// A sample has arrived at the `reader`-th reader: the `sequence`-th (from 1) of one of the writers of `process`,
    /// and its time (that of what no ledger counts is never late).
    Arrival arrived(std::size_t process, std::uint32_t incarnation, std::size_t reader, std::uint32_t writer,
                    std::uint64_t sequence, std::int64_t time_quanta = INT64_MAX);

    /// Nothing announced by `process` is missing.
    [[nodiscard]] bool complete(std::size_t process) const;
    /// "3 of 4 samples of 'requests' from ev3"; empty when complete.
    [[nodiscard]] std::string missing(std::size_t process) const;

  private:
    struct WriterCount {
        std::uint32_t writer;
        std::uint64_t last;
    };
    struct Counts {
        std::uint64_t announced{0};
        std::uint64_t held{0};
        std::int64_t newest{INT64_MIN};       ///< time of the sample that arrived last
        std::int64_t acknowledged{INT64_MIN}; ///< up to when `announced` is all there is
        bool joined_late{false};
        std::vector<WriterCount> writers;
    };
    struct Process {
        std::string name;
        std::uint32_t incarnation{0};
        std::vector<Counts> readers;
    };
    /// More has come than was announced, and the newest is not of a later time. With several writers the newest that
    /// has arrived may not be the newest that was sent; who joined late may have heard what others had counted already.
    static bool holds_too_much(Counts const& counts) {
        return counts.held > counts.announced && counts.newest <= counts.acknowledged && counts.writers.size() == 1 &&
               !counts.joined_late;
    }
    bool enter_incarnation(Process& process, std::uint32_t incarnation); ///< false: it is an old one

    std::vector<Process> processes_;
    std::vector<std::string> readers_; ///< topic by reader
};

} // namespace gridspace::lockstep
