// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/pcapng/pcapng_reader.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <zlib.h>

namespace gridspace::pcapng {
namespace {

constexpr std::uint32_t kSection = 0x0A0D0D0A, kInterface = 1, kPacket = 2, kSimplePacket = 3, kEnhancedPacket = 6;
constexpr std::uint32_t kMicro = 0xA1B2C3D4, kNano = 0xA1B23C4D, kModified = 0xA1B2CD34, kOrder = 0x1A2B3C4D;
constexpr std::size_t kLargestBlock = 16U << 20U;
constexpr std::size_t kMostInterfaces = 65'536;
// Of a compressed file, as of a recording (recorder/mcap/mcap_format.hpp): so many octets, and so many for each of it.
constexpr std::uint64_t kDecompressed = 256ULL << 20U, kDecompressedPerOctet = 200;

constexpr std::size_t padded(std::size_t octets) {
    return (octets + 3) & ~std::size_t{3};
}

/// Nanoseconds of a count of units; wide, because a count times 10^9 does not fit 64 bits.
std::int64_t nanoseconds(std::uint64_t count, std::uint64_t units_per_s) {
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::int64_t>(Wide{count} * 1'000'000'000U / units_per_s);
}

std::uint64_t units_of(std::uint8_t resolution) {
    std::uint64_t units = 1;
    unsigned const exponent = resolution & 0x7FU;
    bool const binary = (resolution & 0x80U) != 0;
    for (unsigned i = 0; i < exponent && i < (binary ? 62U : 18U); ++i) {
        units *= binary ? 2 : 10;
    }
    return units;
}

} // namespace

template <class T>
T Reader::number(std::uint8_t const* from) const {
    T value;
    std::memcpy(&value, from, sizeof value);
    if constexpr (sizeof(T) > 1) {
        return swapped_ != (std::endian::native == std::endian::big) ? std::byteswap(value) : value;
    }
    return value;
}

std::unexpected<Error> Reader::damaged(std::string const& what) const {
    return fail(ExitCode::usage, fmt::format("'{}' is damaged: {} (at octet {})", name_, what, offset_));
}

std::unexpected<Error> Reader::not_decompressed() const {
    return too_large_
               ? fail(ExitCode::usage, fmt::format("'{}' is too large: {}", name_, broken_), "decompress it first")
               : damaged("it cannot be decompressed (" + broken_ + ")");
}

bool Reader::read(std::size_t octets) {
    if (octets > left_) { // no memory for what a damaged length promises
        if (compressed_) {
            too_large_ = true;
            broken_ = fmt::format("it becomes more than {} octets, and {} for each of its own", kDecompressed,
                                  kDecompressedPerOctet);
        }
        truncated_ = truncated_ || left_ != 0;
        return false;
    }
    left_ -= octets;
    block_.resize(octets);
    gzFile const file = static_cast<gzFile>(file_.get());
    int const read = ::gzread(file, block_.data(), static_cast<unsigned>(octets));
    std::size_t const got = read < 0 ? 0 : static_cast<std::size_t>(read);
    int code = Z_OK;
    char const* const why = ::gzerror(file, &code);
    if (code != Z_OK && code != Z_BUF_ERROR && code != Z_STREAM_END) {
        broken_ = code == Z_ERRNO ? std::strerror(errno) : why;
    }
    truncated_ = truncated_ || (got != octets && got != 0) || code == Z_BUF_ERROR; // it ends within what is compressed
    return got == octets;
}

void Reader::Close::operator()(void* file) const {
    ::gzclose(static_cast<gzFile>(file));
}

std::filesystem::path capture_of_run(std::filesystem::path const& folder) {
    std::error_code ignored;
    std::filesystem::path compressed = folder / "bus.pcapng.gz";
    return std::filesystem::exists(compressed, ignored) ? compressed : folder / "bus.pcapng";
}

Result<Reader> Reader::open(std::filesystem::path const& file) {
    Reader out;
    out.name_ = file.string();
    errno = 0;
    out.file_.reset(::gzopen(file.c_str(), "rbe"));
    if (!out.file_) {
        return fail(ExitCode::usage, fmt::format("cannot read '{}': {}", out.name_, std::strerror(errno)));
    }
    std::error_code ec;
    if (std::filesystem::is_directory(file, ec)) {
        return fail(ExitCode::usage, fmt::format("'{}' is a folder", out.name_), "expected a capture: pcapng or pcap");
    }
    out.left_ = std::filesystem::file_size(file, ec);
    out.compressed_ = !ec && ::gzdirect(static_cast<gzFile>(out.file_.get())) == 0;
    if (out.compressed_) {
        out.left_ = kDecompressed + kDecompressedPerOctet * out.left_;
    } else if (ec) { // a pipe: as far as it goes
        out.left_ = ~std::uint64_t{0};
    }
    if (!out.read(4)) {
        return out.broken_.empty()
                   ? fail(ExitCode::usage, fmt::format("'{}' is not a capture: it has fewer than 4 octets", out.name_))
                   : out.not_decompressed();
    }
    auto const magic = out.number<std::uint32_t>(out.block_.data());
    std::uint32_t const turned = std::byteswap(magic);
    if (magic == kSection) {
        out.begun_ = true;
        return out;
    }
    bool const straight = magic == kMicro || magic == kNano || magic == kModified;
    out.swapped_ = turned == kMicro || turned == kNano || turned == kModified;
    if (!straight && !out.swapped_) {
        return fail(ExitCode::usage, fmt::format("'{}' is not a capture: it begins with 0x{:08x}", out.name_, magic),
                    "expected pcapng or pcap");
    }
    out.classic_ = true;
    bool const nano = magic == kNano || turned == kNano;
    out.record_head_ = magic == kModified || turned == kModified ? 24 : 16;
    if (!out.read(20)) {
        return fail(ExitCode::usage, fmt::format("'{}' ends within its header", out.name_));
    }
    Interface only;
    only.name = "pcap";
    only.link_type = static_cast<std::uint16_t>(out.number<std::uint32_t>(out.block_.data() + 16) & 0xFFFFU);
    only.units_per_s = nano ? 1'000'000'000 : 1'000'000;
    out.interfaces_.push_back(only);
    out.offset_ = 24;
    return out;
}

Result<std::optional<Frame>> Reader::next_classic() {
    if (!read(record_head_)) {
        return std::nullopt;
    }
    Frame frame;
    auto const captured = number<std::uint32_t>(block_.data() + 8);
    frame.original_octets = number<std::uint32_t>(block_.data() + 12);
    std::int64_t const scale = interfaces_[0].units_per_s == 1'000'000 ? 1'000 : 1;
    frame.time_ns = std::int64_t{number<std::uint32_t>(block_.data())} * 1'000'000'000 +
                    std::int64_t{number<std::uint32_t>(block_.data() + 4)} * scale;
    if (captured > kLargestBlock) {
        return damaged(fmt::format("a frame of {} octets", captured));
    }
    if (!read(captured)) {
        truncated_ = true;
        return std::nullopt;
    }
    offset_ += record_head_ + captured;
    frame.octets = block_;
    return frame;
}

Result<std::optional<Frame>> Reader::next() {
    auto frame = next_frame();
    return frame && !*frame && !broken_.empty() ? not_decompressed() : frame;
}

Result<std::optional<Frame>> Reader::next_frame() {
    if (classic_) {
        return next_classic();
    }
    for (;;) {
        if (begun_) { // open() has read the type of the first block
            begun_ = false;
            if (!read(4)) {
                return std::nullopt;
            }
            std::uint32_t const section = kSection;
            auto const* const octets = reinterpret_cast<std::uint8_t const*>(&section);
            block_.insert(block_.begin(), octets, octets + 4);
        } else if (!read(8)) {
            return std::nullopt;
        }
        auto const type = number<std::uint32_t>(block_.data());
        if (type == kSection) { // its byte order is not known before its body is read
            std::uint32_t length = 0;
            std::memcpy(&length, block_.data() + 4, 4);
            if (auto ok = section_header(length); !ok) {
                return std::unexpected{ok.error()};
            }
            if (truncated_) {
                return std::nullopt;
            }
            continue;
        }
        auto const length = number<std::uint32_t>(block_.data() + 4);
        if (length < 12 || length % 4 != 0 || length > kLargestBlock) {
            return damaged(fmt::format("a block of {} octets", length));
        }
        if (!read(length - 8)) {
            truncated_ = true;
            return std::nullopt;
        }
        if (number<std::uint32_t>(block_.data() + length - 12) != length) {
            return damaged("the two lengths of a block differ");
        }
        block_.resize(length - 12);
        if (type == kInterface) {
            if (auto ok = interface_block(); !ok) {
                return std::unexpected{ok.error()};
            }
        } else if (type == kPacket || type == kEnhancedPacket || type == kSimplePacket) {
            auto frame = packet_block(type);
            offset_ += length;
            return frame;
        }
        offset_ += length;
    }
}

Result<void> Reader::section_header(std::uint32_t length) {
    if (!read(4)) {
        truncated_ = true;
        return {};
    }
    std::uint32_t order = 0;
    std::memcpy(&order, block_.data(), 4);
    if (order != kOrder && order != std::byteswap(kOrder)) {
        return damaged("a section header without its byte order");
    }
    swapped_ = (order != kOrder) != (std::endian::native == std::endian::big);
    std::uint8_t octets[4];
    std::memcpy(octets, &length, 4);
    length = number<std::uint32_t>(octets);
    if (length < 28 || length % 4 != 0 || length > kLargestBlock) {
        return damaged(fmt::format("a section header of {} octets", length));
    }
    truncated_ = !read(length - 12) || truncated_;
    offset_ += length;
    first_interface_ = static_cast<std::uint32_t>(interfaces_.size());
    return {};
}

Result<void> Reader::interface_block() {
    if (block_.size() < 8) {
        return damaged("an interface without its link type");
    }
    if (interfaces_.size() >= kMostInterfaces) {
        return damaged(fmt::format("more than {} interfaces", kMostInterfaces));
    }
    Interface out;
    out.link_type = number<std::uint16_t>(block_.data());
    for (std::size_t at = 8; at + 4 <= block_.size();) {
        auto const code = number<std::uint16_t>(block_.data() + at),
                   size = number<std::uint16_t>(block_.data() + at + 2);
        at += 4;
        if (code == 0 || at + size > block_.size()) {
            break;
        }
        std::string const text(reinterpret_cast<char const*>(block_.data() + at), size);
        if (code == 2) {
            out.name = text;
        } else if (code == 3) {
            out.description = text;
        } else if (code == 9 && size == 1) {
            out.units_per_s = units_of(block_[at]);
        }
        at += padded(size);
    }
    interfaces_.push_back(std::move(out));
    return {};
}

Result<std::optional<Frame>> Reader::packet_block(std::uint32_t type) {
    Frame frame;
    bool const whole = type != kSimplePacket; // it has its interface, time and options
    std::size_t const head = whole ? 20 : 4;
    if (block_.size() < head) {
        return damaged("a packet without its lengths");
    }
    std::uint32_t captured = 0;
    std::uint32_t interface = 0;
    if (whole) {
        interface = type == kPacket ? number<std::uint16_t>(block_.data()) // and how many were dropped
                                    : number<std::uint32_t>(block_.data());
        captured = number<std::uint32_t>(block_.data() + 12);
        frame.original_octets = number<std::uint32_t>(block_.data() + 16);
    } else {
        frame.original_octets = number<std::uint32_t>(block_.data());
        captured = static_cast<std::uint32_t>(std::min<std::size_t>(frame.original_octets, block_.size() - 4));
    }
    if (captured > block_.size() - head) {
        return damaged(fmt::format("a frame of {} octets in a block of {}", captured, block_.size()));
    }
    std::size_t const index = std::size_t{first_interface_} + interface;
    if (index >= interfaces_.size()) {
        return damaged(fmt::format("a frame of interface {}, which was not described", interface));
    }
    frame.interface = static_cast<std::uint32_t>(index);
    if (whole) {
        std::uint64_t const count =
            std::uint64_t{number<std::uint32_t>(block_.data() + 4)} << 32U | number<std::uint32_t>(block_.data() + 8);
        frame.time_ns = nanoseconds(count, interfaces_[index].units_per_s);
    }
    frame.octets.assign(block_.begin() + static_cast<std::ptrdiff_t>(head),
                        block_.begin() + static_cast<std::ptrdiff_t>(head + captured));
    if (whole) {
        packet_options(frame, head + padded(captured));
    }
    return frame;
}

void Reader::packet_options(Frame& frame, std::size_t at) const {
    while (at + 4 <= block_.size()) {
        auto const code = number<std::uint16_t>(block_.data() + at),
                   size = number<std::uint16_t>(block_.data() + at + 2);
        at += 4;
        if (code == 0 || at + size > block_.size()) {
            return;
        }
        if (code == 1) {
            frame.comment.assign(reinterpret_cast<char const*>(block_.data() + at), size);
        } else if (code == 2 && size == 4) {
            frame.direction = static_cast<Direction>(number<std::uint32_t>(block_.data() + at) & 3U);
        }
        at += padded(size);
    }
}

} // namespace gridspace::pcapng
