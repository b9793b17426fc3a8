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
    /// `processes`: everybody whose samples count; `readers`: the topic of each reader of this process (several may read one).
    LedgerBook(std::vector<std::string> processes, std::vector<std::string> readers);

    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    [[nodiscard]] std::size_t process_index(std::string_view process) const; ///< kUnknown when not of the run
    [[nodiscard]] std::string const& process_name(std::size_t process) const { return processes_[process].name; }
    [[nodiscard]] std::size_t process_count() const { return processes_.size(); }

    /// One ledger line: `process` has sent `sent` samples on `topic` since its incarnation started. Topics that are not read
    /// here do not matter.
    void announced(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent);

    /// For a process that joins a running simulation: what was sent before it was ready counts as held.
    void baseline(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent);

    enum class Arrival {
        expected,
        repeated, ///< seen before, or of an incarnation that is gone: to be dropped
        gap,      ///< samples before this one are lost for good
    };
    /// A sample has arrived at the `reader`-th reader: the `sequence`-th (from 1) of one of the writers of `process`.
    Arrival arrived(std::size_t process, std::uint32_t incarnation, std::size_t reader, std::uint32_t writer,
                    std::uint64_t sequence);

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
        bool joined_late{false};
        std::vector<WriterCount> writers;
    };
    struct Process {
        std::string name;
        std::uint32_t incarnation{0};
        std::vector<Counts> readers;
    };
    bool enter_incarnation(Process& process, std::uint32_t incarnation); ///< false: it is an old one

    std::vector<Process> processes_;
    std::vector<std::string> readers_; ///< topic by reader
};

} // namespace gridspace::lockstep
