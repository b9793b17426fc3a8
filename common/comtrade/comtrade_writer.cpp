// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/comtrade/comtrade_writer.hpp"

#include "common/comtrade/little_endian.hpp"

#include <bit>
#include <fmt/format.h>

namespace gridspace {
Result<ComtradeWriter> ComtradeWriter::create(std::filesystem::path file, ComtradeHeader header) {
    if (file.extension() == ".cfg" || file.extension() == ".dat") {
        file.replace_extension();
    }
    ComtradeWriter out;
    out.header_ = std::move(header);
    for (ComtradeChannel& c : out.header_.analog) {
        c.low = -3.4028235e38; // of a float
        c.high = 3.4028235e38;
    }
    out.cfg_ = file;
    out.cfg_ += ".cfg";
    out.dat_ = file;
    out.dat_ += ".dat";
    out.data_.open(out.dat_, std::ios::binary);
    if (!out.data_) {
        return fail(ExitCode::environment, fmt::format("cannot write {}", out.dat_.string()),
                    "does the folder exist, and may you write there?");
    }
    return out;
}

void ComtradeWriter::row(std::span<double const> analog, std::span<bool const> digital) {
    record_.clear();
    put(record_, rows_ + 1, 4);
    put(record_, comtrade_stamp_us(header_, rows_), 4);
    for (double const x : analog) {
        put(record_, std::bit_cast<std::uint32_t>(static_cast<float>(x)), 4);
    }
    for (std::size_t i = 0; i < digital.size(); i += 16) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 16 && i + k < digital.size(); ++k) {
            word |= digital[i + k] ? 1U << k : 0U;
        }
        put(record_, word, 2);
    }
    data_.write(record_.data(), static_cast<std::streamsize>(record_.size()));
    ++rows_;
}

Result<void> ComtradeWriter::finish() {
    data_.close();
    std::ofstream cfg{cfg_, std::ios::binary};
    cfg << comtrade_cfg(header_, ComtradeFormat::float32, rows_);
    cfg.close();
    if (!data_ || !cfg) {
        return fail(ExitCode::environment, fmt::format("cannot write {}", (data_ ? cfg_ : dat_).string()),
                    "is the disk full?");
    }
    return {};
}

} // namespace gridspace
