// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/pcapng/pcapng_writer.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

namespace gridspace::pcapng {
namespace {

using Octets = std::vector<std::uint8_t>;
constexpr std::size_t kBufferOctets = 256U * 1024U;

/// Appends one block: number, length, body, options, length.
class Block {
  public:
    Block(Octets& out, std::uint32_t type) : out_{out}, start_{out.size()} {
        number(type);
        number(std::uint32_t{0});
    }
    template <class T>
    Block& number(T value) {
        auto const octets = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
        if constexpr (std::endian::native == std::endian::little) {
            out_.insert(out_.end(), octets.begin(), octets.end());
        } else {
            out_.insert(out_.end(), octets.rbegin(), octets.rend());
        }
        return *this;
    }
    /// 64-bit times stand high word first.
    Block& time(std::int64_t ns) {
        auto const bits = static_cast<std::uint64_t>(ns);
        return number(static_cast<std::uint32_t>(bits >> 32U)).number(static_cast<std::uint32_t>(bits));
    }
    Block& octets(std::span<std::uint8_t const> data) {
        out_.insert(out_.end(), data.begin(), data.end());
        out_.resize(out_.size() + (4 - data.size() % 4) % 4);
        return *this;
    }
    Block& option(std::uint16_t code, std::string_view text) {
        if (!text.empty()) {
            text = text.substr(0, 65535);
            number(code).number(static_cast<std::uint16_t>(text.size()));
            octets({reinterpret_cast<std::uint8_t const*>(text.data()), text.size()});
            has_options_ = true;
        }
        return *this;
    }
    template <class T>
    Block& option_number(std::uint16_t code, T value) {
        number(code).number(static_cast<std::uint16_t>(sizeof(T))).number(value);
        out_.resize(out_.size() + (4 - sizeof(T) % 4) % 4);
        has_options_ = true;
        return *this;
    }
    void end() {
        if (has_options_) {
            number(std::uint32_t{0});
        }
        auto const length = static_cast<std::uint32_t>(out_.size() - start_ + 4);
        number(length);
        std::memcpy(out_.data() + start_ + 4, out_.data() + out_.size() - 4, 4);
    }

  private:
    Octets& out_;
    std::size_t start_;
    bool has_options_{false};
};

} // namespace

/// One stream of deflate behind a header without name and date. Each part ends on an octet: a file that was cut off
/// there can be read up to it. (One frame of zstd after another, which would do as well, Wireshark 4.0 does not read.)
class Writer::Gzip {
  public:
    Gzip() {
        constexpr int kFastest = 1, kGzip = 16 + MAX_WBITS, kUsualMemory = 8;
        good_ = ::deflateInit2(&z_, kFastest, Z_DEFLATED, kGzip, kUsualMemory, Z_DEFAULT_STRATEGY) == Z_OK;
    }
    ~Gzip() { ::deflateEnd(&z_); }
    Gzip(Gzip const&) = delete;
    Gzip& operator=(Gzip const&) = delete;

    [[nodiscard]] bool good() const { return good_; }
    /// What the file goes on with.
    std::span<std::uint8_t const> part(Octets const& octets, bool last) {
        out_.resize(::deflateBound(&z_, octets.size()) + 64); // and the end of the part
        z_.next_in = const_cast<Bytef*>(octets.data());       // zlib does not write there
        z_.avail_in = static_cast<uInt>(octets.size());
        z_.next_out = out_.data();
        z_.avail_out = static_cast<uInt>(out_.size());
        ::deflate(&z_, last ? Z_FINISH : Z_SYNC_FLUSH);
        assert(z_.avail_in == 0 && z_.avail_out > 0);
        return {out_.data(), out_.size() - z_.avail_out};
    }

  private:
    z_stream z_{};
    bool good_{false};
    Octets out_;
};

Writer::Writer(UniqueFd fd, std::filesystem::path file) : fd_{std::move(fd)}, file_{std::move(file)} {}
Writer::~Writer() = default;
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;

Result<Writer> Writer::create(std::filesystem::path const& file, std::string_view application) {
    UniqueFd fd{::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (!fd) {
        return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
    }
    Writer out{std::move(fd), file};
    if (file.extension() == ".gz") {
        out.gzip_ = std::make_unique<Gzip>();
        if (!out.gzip_->good()) {
            return fail(ExitCode::environment, fmt::format("cannot write '{}': no memory to compress", file.string()));
        }
    }
    out.buffer_.reserve(kBufferOctets + 4096);
    Block block{out.buffer_, 0x0A0D0D0A};
    block.number(std::uint32_t{0x1A2B3C4D}).number(std::uint16_t{1}).number(std::uint16_t{0}).number(std::int64_t{-1});
    block.option(4, application).end();
    return out;
}

std::uint32_t Writer::add_interface(std::string_view name, std::string_view description) {
    constexpr std::uint16_t kEthernet = 1;
    Block block{buffer_, 1};
    block.number(kEthernet).number(std::uint16_t{0}).number(std::uint32_t{0});
    block.option(2, name).option(3, description).option_number(9, std::uint8_t{9}).end(); // stamps in 10^-9 s
    return interfaces_++;
}

Result<void> Writer::write(std::uint32_t interface, std::int64_t time_ns, std::span<std::uint8_t const> frame,
                           std::string_view comment, Direction direction) {
    assert(interface < interfaces_);
    Block block{buffer_, 6};
    auto const size = static_cast<std::uint32_t>(frame.size());
    block.number(interface).time(time_ns).number(size).number(size).octets(frame);
    if (direction != Direction::unknown) {
        block.option_number(2, static_cast<std::uint32_t>(direction));
    }
    block.option(1, comment).end();
    ++frames_;
    return flush_when_full();
}

Result<void> Writer::statistics(std::uint32_t interface, std::int64_t time_ns, std::uint64_t received,
                                std::uint64_t dropped) {
    assert(interface < interfaces_);
    Block block{buffer_, 5};
    block.number(interface).time(time_ns).option_number(4, received).option_number(5, dropped).end();
    return flush_when_full();
}

Result<void> Writer::flush_when_full() {
    return buffer_.size() < kBufferOctets ? Result<void>{} : flush();
}

Result<void> Writer::flush() {
    if (buffer_.empty()) {
        return {};
    }
    auto const ok = put(gzip_ ? gzip_->part(buffer_, false) : buffer_);
    buffer_.clear(); // also when the disk is full: memory would grow meanwhile
    return ok;
}

Result<void> Writer::put(std::span<std::uint8_t const> octets) {
    while (!octets.empty()) {
        ssize_t const n = ::write(fd_.get(), octets.data(), octets.size());
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return fail(ExitCode::environment,
                        fmt::format("cannot write '{}': {}", file_.string(), std::strerror(errno)));
        }
        octets = octets.subspan(static_cast<std::size_t>(n));
    }
    return {};
}

Result<void> Writer::close() {
    auto const ok = !fd_ ? Result<void>{} : gzip_ ? put(gzip_->part(buffer_, true)) : flush();
    fd_.reset();
    return ok;
}

} // namespace gridspace::pcapng
