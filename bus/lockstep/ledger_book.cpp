// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/ledger_book.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::lockstep {

LedgerBook::LedgerBook(std::vector<std::string> processes, std::vector<std::string> readers)
    : readers_{std::move(readers)} {
    std::sort(processes.begin(), processes.end());
    for (std::string& name : processes) {
        Process process;
        process.name = std::move(name);
        process.readers.resize(readers_.size());
        for (Counts& counts : process.readers) {
            counts.writers.reserve(8);
        }
        processes_.push_back(std::move(process));
    }
}

std::size_t LedgerBook::process_index(std::string_view process) const {
    auto const it = std::lower_bound(processes_.begin(), processes_.end(), process,
                                     [](Process const& p, std::string_view name) { return p.name < name; });
    return it != processes_.end() && it->name == process ? static_cast<std::size_t>(it - processes_.begin()) : kUnknown;
}

bool LedgerBook::enter_incarnation(Process& process, std::uint32_t incarnation) {
    if (incarnation < process.incarnation) {
        return false;
    }
    if (incarnation > process.incarnation) {
        process.incarnation = incarnation;
        for (Counts& counts : process.readers) {
            counts.announced = 0;
            counts.held = 0;
            counts.newest = counts.acknowledged = INT64_MIN;
            counts.joined_late = false;
            counts.writers.clear();
        }
    }
    return true;
}

void LedgerBook::announced(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent) {
    if (!enter_incarnation(processes_[process], incarnation)) {
        return;
    }
    for (std::size_t r = 0; r < readers_.size(); ++r) {
        if (readers_[r] == topic) {
            Counts& counts = processes_[process].readers[r];
            counts.announced = std::max(counts.announced, sent);
        }
    }
}

void LedgerBook::baseline(std::size_t process, std::uint32_t incarnation, std::string_view topic, std::uint64_t sent) {
    if (!enter_incarnation(processes_[process], incarnation)) {
        return;
    }
    for (std::size_t r = 0; r < readers_.size(); ++r) {
        if (readers_[r] == topic) {
            Counts& counts = processes_[process].readers[r];
            counts.announced = sent;
            counts.held = sent;
            counts.joined_late = true;
        }
    }
}

std::string LedgerBook::acknowledged(std::size_t process, std::uint32_t incarnation, std::int64_t time_quanta) {
    std::string out;
    if (!enter_incarnation(processes_[process], incarnation)) {
        return out;
    }
    for (std::size_t r = 0; r < readers_.size(); ++r) {
        Counts& counts = processes_[process].readers[r];
        counts.acknowledged = std::max(counts.acknowledged, time_quanta);
        if (holds_too_much(counts)) {
            out += fmt::format("{}{} samples of '{}' have come, and its ledger says {}", out.empty() ? "" : ", ",
                               counts.held, readers_[r], counts.announced);
        }
    }
    return out;
}

LedgerBook::Arrival LedgerBook::arrived(std::size_t process, std::uint32_t incarnation, std::size_t reader,
                                        std::uint32_t writer, std::uint64_t sequence, std::int64_t time_quanta) {
    if (!enter_incarnation(processes_[process], incarnation)) {
        return Arrival::repeated;
    }
    Counts& counts = processes_[process].readers[reader];
    auto it = std::find_if(counts.writers.begin(), counts.writers.end(),
                           [&](WriterCount const& w) { return w.writer == writer; });
    if (it == counts.writers.end()) {
        counts.writers.push_back({writer, 0});
        it = counts.writers.end() - 1;
    }
    if (sequence <= it->last) {
        return Arrival::repeated;
    }
    bool const first_of_late_joiner = it->last == 0 && counts.joined_late;
    bool const gap = sequence != it->last + 1 && !first_of_late_joiner;
    it->last = sequence;
    ++counts.held;
    counts.newest = time_quanta;
    return gap ? Arrival::gap : holds_too_much(counts) ? Arrival::late : Arrival::expected;
}

bool LedgerBook::complete(std::size_t process) const {
    return std::all_of(processes_[process].readers.begin(), processes_[process].readers.end(),
                       [](Counts const& counts) { return counts.held >= counts.announced; });
}

std::string LedgerBook::missing(std::size_t process) const {
    std::string out;
    for (std::size_t r = 0; r < readers_.size(); ++r) {
        Counts const& counts = processes_[process].readers[r];
        if (counts.held < counts.announced) {
            out += fmt::format("{}{} of {} samples of '{}' from {}", out.empty() ? "" : ", ",
                               counts.announced - counts.held, counts.announced, readers_[r], processes_[process].name);
        }
    }
    return out;
}

} // namespace gridspace::lockstep
