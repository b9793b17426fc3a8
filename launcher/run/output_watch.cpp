// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/output_watch.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

namespace gridspace::launcher {

OutputWatch::OutputWatch(std::filesystem::path file, std::string text)
    : file_{std::move(file)}, text_{std::move(text)} {}

bool OutputWatch::found() {
    std::ifstream stream{file_, std::ios::binary};
    stream.seekg(static_cast<std::streamoff>(read_));
    std::array<char, 65536> buffer{};
    while (!found_ && stream) {
        stream.read(buffer.data(), buffer.size());
        end_.append(buffer.data(), static_cast<std::size_t>(stream.gcount()));
        read_ += static_cast<std::uintmax_t>(stream.gcount());
        found_ = end_.find(text_) != std::string::npos;
        end_.erase(0, end_.size() - std::min(end_.size(), text_.size() - 1));
    }
    return found_;
}

} // namespace gridspace::launcher
