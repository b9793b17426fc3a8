// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/folder/write_file.hpp"

#include "common/unique_fd.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

std::unexpected<Error> cannot_write(std::filesystem::path const& file, int why) {
    return fail(ExitCode::environment, fmt::format("cannot write '{}'{}{}", file.string(), why == 0 ? "" : ": ",
                                                   why == 0 ? "" : std::strerror(why)));
}

} // namespace

Result<void> write_file(std::filesystem::path const& file, std::string_view text) {
    errno = 0;
    std::ofstream stream{file, std::ios::trunc | std::ios::binary};
    stream << text;
    stream.close();
    return stream ? Result<void>{} : cannot_write(file, errno);
}

Result<void> replace_file(std::filesystem::path const& file, std::string_view text) {
    std::filesystem::path const fresh = file.string() + ".new";
    ::unlink(fresh.c_str()); // of a process that was killed
    UniqueFd const fd{::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644)};
    int why = fd ? 0 : errno;
    for (std::size_t done = 0; why == 0 && done < text.size();) {
        ssize_t const written = ::write(fd.get(), text.data() + done, text.size() - done);
        why = written < 0 && errno != EINTR ? errno : 0;
        done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
    }
    if (why == 0 && ::rename(fresh.c_str(), file.c_str()) != 0) {
        why = errno;
    }
    if (why != 0) {
        ::unlink(fresh.c_str());
        return cannot_write(file, why);
    }
    return {};
}

Result<void> check_writable(std::filesystem::path const& file) {
    struct stat found{};
    bool const exists = ::stat(file.c_str(), &found) == 0;
    if (exists && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode)) {
        return {};
    }
    UniqueFd const fd{::open(file.c_str(), O_WRONLY | O_CLOEXEC | (exists ? O_APPEND : O_CREAT | O_EXCL), 0644)};
    if (!fd) {
        return cannot_write(file, errno);
    }
    if (!exists) {
        ::unlink(file.c_str());
    }
    return {};
}

} // namespace gridspace::launcher
