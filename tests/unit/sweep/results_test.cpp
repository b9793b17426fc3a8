// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_page.hpp"
#include "launcher/sweep/study_statistics.hpp"
#include "launcher/sweep/table_file.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <sqlite3.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using config::Node;
using testing::HasSubstr;

class Results : public testing::Test {
  protected:
    Results() { fs::create_directories(folder_); }
    ~Results() override { fs::remove_all(folder_); }

    fs::path write(std::string const& name, std::string const& text) const {
        std::ofstream{folder_ / name} << text;
        return folder_ / name;
    }

    fs::path folder_ = fs::temp_directory_path() / ("gridspace-sweep-" + std::to_string(::getpid()));
};

RunRecord record(double value, std::optional<bool> passed, std::string const& name = "v_min") {
    RunRecord r;
    r.exit = passed == false ? 1 : 0;
    r.cause = passed == false ? "not as expected: " + name : "";
    r.values.push_back({name, "min_of", "p.u.", value, 0.95, std::nullopt, passed, false});
    return r;
}

struct Made {
    Study study;
    StudyPlan plan;
    std::vector<std::optional<RunRecord>> records;
};

/// Three runs of a parameter with hostile texts: passed, failed, not done.
Made made() {
    Made m;
    m.study.name = "s";
    m.study.description = "</script><script>alert(1)</script>";
    Parameter p;
    p.name.name = "x";
    p.paths = {{"a.x", {}}};
    for (char const* text : {"1", "<img src=x onerror=alert(1)>", "a, \"b\"\nc"}) {
        p.values.push_back(Node::scalar(text));
    }
    m.study.parameters = {p};
    m.plan.scenario = "scenario";
    m.plan.results = {"v_min"};
    for (Node const& value : p.values) {
        StudyRun run;
        run.point = {value};
        run.key = "key" + std::to_string(m.plan.runs.size());
        m.plan.runs.push_back(std::move(run));
    }
    m.records = {record(0.97, true), record(0.94, false), std::nullopt};
    m.records[1]->is_kept = true;
    m.records[1]->cause = "<b>cause</b>";
    return m;
}

TEST_F(Results, CsvQuotesWhatItMustAndLeavesEmptyWhatIsNotThere) {
    Made const m = made();
    std::string const csv = to_csv(make_table(m.study, m.plan, m.records, {"/st udy"}));
    EXPECT_THAT(csv, testing::StartsWith("run,key,x,repetition,seed,state,exit,cause,wall_s,simulated_s,v_min,folder,"
                                         "command\n1,key0,1,1,0,passed,0,,0,0,0.97,,"));
    EXPECT_THAT(csv, HasSubstr("\n3,key2,\"a, \"\"b\"\"\nc\",1,0,open,,,,,,,"));
    EXPECT_THAT(csv, HasSubstr("/st udy/runs/key1/run"));
    EXPECT_THAT(csv, HasSubstr("run '/st udy/runs/key1/scenario.yaml'"));
}

TEST_F(Results, DatabaseHasTheSameRowsWithNumbersAsNumbers) {
    Made const m = made();
    ResultTable const table = make_table(m.study, m.plan, m.records, {folder_});
    ASSERT_TRUE(write_database(folder_ / "results.sqlite", table));
    ASSERT_TRUE(write_database(folder_ / "results.sqlite", table)) << "it takes the place of an older one";
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder_ / "results.sqlite").c_str(), &database), SQLITE_OK);
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database, "SELECT count(*), sum(v_min), max(typeof(v_min)), max(x) FROM runs", -1,
                                 &statement, nullptr),
              SQLITE_OK);
    ASSERT_EQ(sqlite3_step(statement), SQLITE_ROW);
    EXPECT_EQ(sqlite3_column_int(statement, 0), 3);
    EXPECT_DOUBLE_EQ(sqlite3_column_double(statement, 1), 0.97 + 0.94);
    EXPECT_STREQ(reinterpret_cast<char const*>(sqlite3_column_text(statement, 2)), "real");
    EXPECT_STREQ(reinterpret_cast<char const*>(sqlite3_column_text(statement, 3)), "a, \"b\"\nc");
    sqlite3_finalize(statement);
    sqlite3_close(database);
}

TEST_F(Results, ADatabaseThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
    auto const ok = write_database(folder_ / "no such folder" / "results.sqlite", {{"a"}, {}});
    ASSERT_FALSE(ok);
    EXPECT_THAT(ok.error().message, HasSubstr("cannot write"));
}

TEST_F(Results, PageEscapesWhateverNamesAndValuesAre) {
    Made const m = made();
    std::string const page = study_page(m.study, m.plan, m.records, {folder_});
    EXPECT_THAT(page, testing::Not(HasSubstr("<img")));
    EXPECT_THAT(page, testing::Not(HasSubstr("<b>cause")));
    EXPECT_THAT(page, testing::Not(HasSubstr("<script>alert")));
    EXPECT_THAT(page, HasSubstr("1 of 3 runs passed, 1 failed, 1 are not done yet"));
    EXPECT_THAT(page, HasSubstr("runs/key1/run/report/index.html"));
}

TEST_F(Results, StatisticsAreThoseOfTheValues) {
    std::vector<std::optional<RunRecord>> records;
    for (int i = 0; i <= 100; ++i) {
        records.emplace_back(record(i, i >= 10));
    }
    records.emplace_back(std::nullopt);
    auto const s = statistics_of({"v_min", "missing"}, records);
    ASSERT_EQ(s.size(), 2U);
    EXPECT_EQ(s[0].count, 101U);
    EXPECT_EQ(s[0].failed, 10U);
    EXPECT_DOUBLE_EQ(s[0].median, 50);
    EXPECT_DOUBLE_EQ(s[0].p05, 5);
    EXPECT_DOUBLE_EQ(s[0].p95, 95);
    EXPECT_DOUBLE_EQ(s[0].mean, 50);
    EXPECT_EQ(s[0].lowest, 0U);
    EXPECT_EQ(s[0].highest, 100U);
    EXPECT_EQ(s[1].count, 0U);
}

TEST_F(Results, WorstCasesAreEarlyEndsThenTheFarthestBeyondALimitThenTheNearestToOne) {
    std::vector<std::optional<RunRecord>> records{record(0.99, true), record(0.90, false), record(0.951, true),
                                                  record(0.85, false), RunRecord{}};
    records[4]->exit = 4;
    records[4]->cause = "died";
    std::vector<std::size_t> order;
    auto const cases = worst_cases(statistics_of({"v_min"}, records), records, 4);
    for (WorstCase const& c : cases) {
        order.push_back(c.run);
    }
    EXPECT_EQ(order, (std::vector<std::size_t>{4, 3, 1, 2}));
    EXPECT_EQ(cases[0].why, "died");
    EXPECT_EQ(cases[1].why, "v_min is 0.85 p.u., and the limit 0.95");
}

TEST_F(Results, ARecordReadsBackAndAHalfWrittenOneIsNone) {
    RunRecord r = record(0.94, false);
    r.wall_s = 1.5;
    ASSERT_TRUE(write_record(folder_ / "record.json", r));
    auto const again = read_record(folder_ / "record.json");
    ASSERT_TRUE(again);
    EXPECT_EQ(again->exit, 1);
    EXPECT_EQ(again->cause, r.cause);
    EXPECT_EQ(again->find("v_min")->value, 0.94);
    EXPECT_EQ(again->find("v_min")->passed, false);
    EXPECT_EQ(again->find("v_min")->high, std::nullopt);
    EXPECT_FALSE(read_record(write("half.json", "{\"exit\": 0, \"cau")));
    EXPECT_FALSE(read_record(write("other.json", "[1, 2]")));
    EXPECT_FALSE(read_record(folder_ / "none.json"));
}

TEST_F(Results, ARunWithoutAReportIsAnEarlyEndThatQuotesItsError) {
    RunRecord const r =
        collect_run(folder_ / "run", write("output.log", "note: x\nerror: no namespaces\n  do this\n"), 3, 1);
    EXPECT_EQ(r.exit, 3);
    EXPECT_EQ(r.cause, "error: no namespaces / do this");
    EXPECT_EQ(collect_run(folder_ / "run", folder_ / "none", 0, 1).exit, 4) << "success without a report is none";
    EXPECT_FALSE(r.is_final());
}

TEST_F(Results, ColumnsOfTablesAreReadByName) {
    auto const file = write("t.csv", "\xef\xbb\xbfx, y\r\n1,\"a, \"\"b\"\"\"\r\n\r\n2,c\r\n");
    EXPECT_EQ(*read_column(file, "x", 10), (std::vector<std::string>{"1", "2"}));
    EXPECT_EQ(*read_column(file, "y", 10), (std::vector<std::string>{"a, \"b\"", "c"}));
}

TEST_F(Results, MistakesOfTablesAreNamedWithTheirLine) {
    auto const mistake = [&](std::string const& text, std::string const& column) {
        auto const read = read_column(write("t.csv", text), column, 2);
        return read ? "" : read.error().message;
    };
    EXPECT_THAT(mistake("x,y\n1,2\n", "z"), HasSubstr("t.csv:1: there is no column 'z'"));
    EXPECT_THAT(mistake("x,x\n1,2\n", "x"), HasSubstr("the column 'x' is there 2 times"));
    EXPECT_THAT(mistake("x,y\n1\n", "x"), HasSubstr("t.csv:2: 1 cells, where the first row has 2"));
    EXPECT_THAT(mistake("x,y\n1,\n", "y"), HasSubstr("t.csv:2: the cell of 'y' is empty"));
    EXPECT_THAT(mistake("x,y\n1,\"2\n", "x"), HasSubstr("t.csv:2: a quote is not closed"));
    EXPECT_THAT(mistake("x\n", "x"), HasSubstr("no row"));
    EXPECT_THAT(mistake("x\n1\n2\n3\n", "x"), HasSubstr("t.csv:4: more than 2 rows"));
    EXPECT_THAT(read_column(folder_ / "none.csv", "x", 2).error().message, HasSubstr("cannot be read"));
}

} // namespace
} // namespace gridspace::launcher
