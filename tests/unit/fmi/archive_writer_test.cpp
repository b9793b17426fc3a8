// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive_writer.hpp"

#include "fmi/archive.hpp"

#include <gtest/gtest.h>
#include <span>

namespace gridspace::fmi {
namespace {

std::vector<ArchiveFile> some_files() {
    return {
        {"modelDescription.xml", "<a/>"}, {"binaries/x/empty", ""}, {"resources/zeros", std::string(100'000, '\0')}};
}

TEST(ArchiveWriter, MakesAZipFileThatReadsBackInItsOrder) {
    auto const sut = make_archive(some_files());
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_LT(sut->size(), 2000U) << "it is compressed";

    auto const archive = Archive::open(std::as_bytes(std::span{*sut}), "a.zip");

    ASSERT_TRUE(archive) << archive.error().message;
    ASSERT_EQ(archive->entries().size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(archive->entries()[i].name, some_files()[i].name);
        EXPECT_EQ(archive->read(some_files()[i].name).value_or("nothing"), some_files()[i].content);
    }
}

TEST(ArchiveWriter, GivesTheSameOctetsForTheSameFiles) {
    EXPECT_EQ(*make_archive(some_files()), *make_archive(some_files()));
    auto other = some_files();
    other.back().content.back() = 'x';
    EXPECT_NE(*make_archive(some_files()), *make_archive(other));
}

} // namespace
} // namespace gridspace::fmi
