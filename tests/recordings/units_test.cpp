// Units and frame rates in files are accepted in all common spellings or rejected, by every reader.
#include "recordings/units.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "recordings/recording_summary.h"
#include "tests/recordings/recording_folder.h"

namespace throng::units_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kTurn_rad = 2 * std::numbers::pi;

TEST(Units, AcceptAllSpellings) {
  const struct {
    Quantity quantity;
    double in_si;
    std::vector<const char*> spellings;
  } cases[] = {
      {Quantity::kLength, 1, {"m", "M", "metre", "Metres", "meter", "METERS", " m "}},
      {Quantity::kLength, 0.01, {"cm", "CM", "centimetre", "centimeters"}},
      {Quantity::kLength, 0.001, {"mm", "millimeter", "Millimetres"}},
      {Quantity::kLength, 1000, {"km", "kilometers"}},
      {Quantity::kLength, 0.3048, {"ft", "foot", "feet", "ft."}},
      {Quantity::kLength, 0.0254, {"in", "inch", "inches", "in."}},
      {Quantity::kTime, 1, {"s", "sec", "seconds", "sec."}},
      {Quantity::kTime, 1e-3, {"ms", "mS", "msec", "Milliseconds"}},
      {Quantity::kTime, 1e-6, {"us", "\xC2\xB5s", "\xCE\xBCs", "\xB5s", "microseconds"}},
      {Quantity::kTime, 1e-9, {"ns", "nanoseconds"}},
      {Quantity::kTime, 60, {"min", "minutes"}},
      {Quantity::kTime, 3600, {"h", "hr", "hours"}},
      {Quantity::kAngle, 1, {"rad", "radians"}},
      {Quantity::kAngle, kTurn_rad / 360, {"deg", "Degrees", "\xC2\xB0", "\xB0"}},
      {Quantity::kSpeed, 1, {"m/s", "mps", "metres per second", "m s-1", "m s^-1", "m / s"}},
      {Quantity::kSpeed, 0.01, {"cm/s"}},
      {Quantity::kSpeed, 1 / 3.6, {"km/h", "kph"}},
      {Quantity::kSpeed, 0.3048, {"ft/s"}},
  };
  for (const auto& [quantity, in_si, spellings] : cases)
    for (const char* spelling : spellings) {
      SCOPED_TRACE(spelling);
      const std::optional<Unit> unit = unit_named(spelling);
      ASSERT_TRUE(unit);
      EXPECT_EQ(unit->quantity, quantity);
      EXPECT_DOUBLE_EQ(unit->in_si, in_si);
    }
  for (const char* none : {"", "x", "mid", "smooth", "m/m", "s/m", "/", "m/s/s", "1"})
    EXPECT_FALSE(unit_named(none)) << none;
  for (const char* unread :
       {"px", "furlong", "Miles", "Mm", "MM", "Ms", "MS", "Msec", "gon", "ticks"})
    EXPECT_EQ(unit_named(unread)->in_si, 0) << unread;
  EXPECT_FALSE(unit_named("Mm/s"));
}

class RecordedUnits : public RecordingTest {
 protected:
  Eigen::Vector2d first(std::string_view text, RecordingOptions options = {}) const {
    return track(*read(text, std::move(options)), 0)[0].position_m;
  }
};

/// Notations of a unit in a column name.
constexpr const char* kSpellings[] = {"{} [{}]",    "{}/{}", "{} ({})",
                                      "{} (in {})", "{} {}", "{}_{}"};

std::string named(const char* spelling, const char* name, const char* unit) {
  return fmt::format(fmt::runtime(spelling), name, unit);
}

TEST_F(RecordedUnits, GiveEqualTracks) {
  const std::pair<const char*, double> x_units[] = {{"m", 1}, {"cm", 0.01}, {"ft", 0.3048}};
  const std::pair<const char*, double> y_units[] = {{"m", 1}, {"mm", 0.001}, {"in", 0.0254}};
  const std::pair<const char*, double> times[] = {{"s", 1}, {"ms", 0.001}, {"min", 60}};
  int files = 0;
  for (const char* spelling : kSpellings)
    for (const auto& [x_unit, x_m] : x_units)
      for (const auto& [y_unit, y_m] : y_units)
        for (const auto& [time, time_s] : times) {
          std::string text =
              fmt::format("id,{},{},{}\n", named(spelling, "t", time), named(spelling, "x", x_unit),
                          named(spelling, "y", y_unit));
          SCOPED_TRACE(text);
          for (int frame = 0; frame < 101; ++frame)
            for (int id = 0; id < 2; ++id)
              text += fmt::format("{},{:.9f},{:.9f},{:.9f}\n", id, 0.04 * frame / time_s,
                                  0.05 * frame / x_m, (3 * id + 0.01 * frame) / y_m);
          const auto recording = read(text);
          const RecordingFacts& facts = recording->facts();
          EXPECT_NEAR(facts.bounds.area_m2(), 5 * 4, 1e-6);
          EXPECT_EQ(facts.fps, 25);
          EXPECT_EQ(facts.duration_s, 4);
          EXPECT_NEAR(summary_of(*recording).speed_mps.median, std::hypot(1.25, 0.25), 1e-6);
          EXPECT_TRUE(facts.anomalies.empty());
          ++files;
        }
  EXPECT_EQ(files, 162);
}

TEST_F(RecordedUnits, DifferByColumn) {
  EXPECT_EQ(first("id,t,x [cm],y [m]\n1,0,300,4\n"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(first("id,t,x [m],y [cm]\n1,0,3,400\n"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(first("id;t;x [ft];y [in]\n1;0;1;2\n"), Eigen::Vector2d(0.3048, 0.0508));
  const auto z = read("id,t,x [cm],y [cm],z [m]\n1,0,300,400,1.75\n2,0,0,0,1.5\n",
                      {.tracked_point = TrackedPoint::kHead});
  EXPECT_FLOAT_EQ(static_cast<float>(*z->people()[0].height_m), 1.75f);
  const auto same = read("id,t,x [cm],y,z\n1,0,300,400,175\n2,0,0,0,150\n",
                         {.tracked_point = TrackedPoint::kHead});
  EXPECT_EQ(track(*same, 0)[0].position_m, Eigen::Vector2d(3, 4)) << "the unit of x applies to all";
  EXPECT_FLOAT_EQ(static_cast<float>(*same->people()[0].height_m), 1.75f);
  const auto unknown = read("id,t,x [cm],y [m],z\n1,0,300,4,175\n2,0,0,0,150\n",
                            {.tracked_point = TrackedPoint::kHead});
  EXPECT_FALSE(unknown->people()[0].height_m) << "z may be in either";
  EXPECT_THAT(unknown->facts().anomalies,
              testing::Contains(testing::Field(&Anomaly::what, HasSubstr("z without a unit"))));
}

TEST_F(RecordedUnits, AcceptManySpellings) {
  for (const char* header : {"id,t,X[CM],Y[CM]",
                             "id,t,x / cm,y / cm",
                             "id,t,x (centimetres),y (centimeters)",
                             "id,t,x [in cm],y [in cm]",
                             "id,t,x in cm,y in cm",
                             "id,t,x_in_cm,y_in_cm",
                             "id,t,pos_x [cm],pos_y [cm]",
                             "id,t,posX_cm,posY_cm",
                             "id,t,posXCm,posYCm",
                             "id,t,X Pos (cm),Y Pos (cm)",
                             "id,t,x_[cm],y_[cm]",
                             "id,t,x (unit: cm),y (unit: cm)",
                             "\"id\",\"t\",\"x [cm]\",\"y [cm]\"",
                             "id,t,'x [cm]','y [cm]'",
                             "id,t,x {cm},y {cm}",
                             "id,t,x-cm,y.cm",
                             "id,t,x [Cm],y [cM]",
                             "id,t,x (smoothed) [cm],y (smoothed) [cm]",
                             "id,t,x/[cm],y/(cm)",
                             "id;t;x, cm;y, cm",
                             "id\tt\tx [cm]\ty [cm]",
                             "id|t|x [cm]|y [cm]"}) {
    SCOPED_TRACE(header);
    const char separator = std::string_view(header).find('|') != std::string_view::npos ? '|' : 0;
    const char parting = separator != 0                                                  ? separator
                         : std::string_view(header).find(';') != std::string_view::npos  ? ';'
                         : std::string_view(header).find('\t') != std::string_view::npos ? '\t'
                                                                                         : ',';
    EXPECT_EQ(first(fmt::format("{0}\n1{1}0{1}300{1}400\n", header, parting),
                    {.columns = separator != 0 ? "id=id" : "", .separator = separator}),
              Eigen::Vector2d(3, 4));
  }
}

TEST_F(RecordedUnits, AreReadBetweenBlanks) {
  for (const char* header :
       {"id t x/cm y/cm", "id t x [cm] y [cm]", "id t x (in cm) y (in cm)", "id t x cm y cm",
        "id t x in cm y in cm", "id t x_cm y_cm", "id t x / cm y / cm",
        "\"id\" \"t\" \"x [cm]\" \"y [cm]\"", "id t[s] x[cm] y[cm]", "id t s x cm y cm"}) {
    SCOPED_TRACE(header);
    EXPECT_EQ(first(fmt::format("{}\n1 0 300 400\n1 1 301 400\n", header)), Eigen::Vector2d(3, 4));
  }
  EXPECT_EQ(first("id t x y m\n1 0 3 4 70\n"), Eigen::Vector2d(3, 4)) << "m is a column here";
  EXPECT_EQ(first("id t x in y in\n1 0 100 200\n"), Eigen::Vector2d(2.54, 5.08));
}

TEST_F(RecordedUnits, DistinguishInchFromIn) {
  for (const char* header : {"id,t,x [in],y [in]", "id,t,x in,y in", "id,t,x/in,y/in",
                             "id,t,x_in,y_in", "id,t,x (in in),y (in inches)", "id,t,x inch,y in."})
    EXPECT_EQ(first(fmt::format("{}\n1,0,100,200\n", header)), Eigen::Vector2d(2.54, 5.08))
        << header;
  for (const char* header : {"id,t,x (in m),y (in metres)", "id,t,x in m,y in meter"})
    EXPECT_EQ(first(fmt::format("{}\n1,0,100,200\n", header)), Eigen::Vector2d(100, 200)) << header;
}

TEST_F(RecordedUnits, KeepOrdinaryNames) {
  // Despite their suffixes these are not x, y and t.
  EXPECT_EQ(
      first("x_smooth,y_smooth,x_mid,x_min,x_s,y_h,t_min_s,id,t,x,y\n9,9,9,9,9,9,9,1,0,3,4\n"),
      Eigen::Vector2d(3, 4));
  EXPECT_EQ(first("id,time,pos_x,pos_y\n1,0,3,4\n"), Eigen::Vector2d(3, 4));
  for (const char* header : {"id,t,x_smooth,y_smooth", "id,t,x_min,y_min", "id,t,x_left,y_left"})
    EXPECT_THAT(rejection(fmt::format("{}\n1,0,3,4\n", header)), HasSubstr("--columns")) << header;
  EXPECT_EQ(first("id,t,x_smooth,y_smooth\n1,0,3,4\n", {.columns = "x=x_smooth,y=y_smooth"}),
            Eigen::Vector2d(3, 4));
  EXPECT_EQ(first("id,t,east_cm,north [ft]\n1,0,300,10\n", {.columns = "x=east_cm,y=north [ft]"}),
            Eigen::Vector2d(3, 3.048));
  EXPECT_EQ(first("id,t,x [px],y [px],x [cm],y [cm]\n1,0,9,9,300,400\n"), Eigen::Vector2d(3, 4))
      << "the column with a known unit";
}

TEST_F(RecordedUnits, RejectUnknownUnitsWithAlternatives) {
  for (const char* unit : {"px", "pixel", "Pixels", "furlong", "voxels", "-", "1"})
    for (const char* spelling : {"{} [{}]", "{}/{}", "{} ({})", "{} (in {})"}) {
      const std::string header =
          fmt::format("id,t,{},{}", named(spelling, "x", unit), named(spelling, "y", unit));
      EXPECT_THAT(
          rejection("# a comment\n" + header + "\n1,0,3,4\n"),
          AllOf(StartsWith("recording:2: expected a unit of length (m, cm, mm, km, ft, in)"),
                HasSubstr("; --unit overrides the file")))
          << header;
    }
  EXPECT_THAT(rejection("id,t,x,y_px\n1,0,3,4\n"), HasSubstr("expected a unit of length"));
  EXPECT_THAT(rejection("id,t,x_px,y_px\n1,0,3,4\n"), HasSubstr("found 'px'"));
  EXPECT_THAT(rejection("id,t,x px,y px\n1,0,3,4\n"), HasSubstr("found 'px'"));
  EXPECT_THAT(rejection("id,t,x,y,z [px]\n1,0,3,4,5\n"), HasSubstr("the column 'z [px]'"));
  EXPECT_THAT(rejection("id,t,x [s],y [m]\n1,0,3,4\n"), HasSubstr("found 's'"));
  EXPECT_THAT(rejection("id,t,x [m/s],y [m/s]\n1,0,3,4\n"), HasSubstr("found 'm/s'"));
  EXPECT_THAT(rejection("id,t [fortnight],x,y\n1,0,3,4\n"),
              HasSubstr("a unit of time (s, ms, us, ns, min, h) in the column 't [fortnight]'"));
  EXPECT_THAT(rejection("id,t [m],x,y\n1,0,3,4\n"), HasSubstr("a unit of time"));
  EXPECT_THAT(rejection("id,t,x,y,heading [gon]\n1,0,3,4,5\n"),
              HasSubstr("a unit of angle (rad, deg)"));
  EXPECT_THAT(rejection("id,frame [s],x,y\n1,0,3,4\n", {.fps = 25}),
              HasSubstr("a column of frames"));
  EXPECT_EQ(first("id,t,x,y,mood [furlong]\n1,0,3,4,5\n"), Eigen::Vector2d(3, 4))
      << "in an ignored column";
}

TEST_F(RecordedUnits, DistinguishCapitals) {
  for (const char* header : {"id,t,x [Mm],y [Mm]", "id,t,x [MM],y [MM]", "id,t,x/Mm,y/Mm",
                             "id,t,x (in Mm),y (in Mm)", "id,t,x Mm,y Mm", "id,t,x_Mm,y_MM"})
    EXPECT_THAT(rejection(fmt::format("{}\n1,0,3,4\n", header)),
                AllOf(StartsWith("recording:1: expected a unit of length (m, cm, mm, km, ft, in)"),
                      HasSubstr("'M")))
        << header;
  for (const char* header : {"id,t [Ms],x,y", "id,t [MS],x,y", "id,time_Ms,x,y", "id,t (Msec),x,y"})
    EXPECT_THAT(rejection(fmt::format("{}\n1,0,3,4\n", header)), HasSubstr("a unit of time"))
        << header;
  EXPECT_THAT(rejection("id,t,x,y\ns,,,\n,Ms,Mm,Mm\n1,0,3,4\n"), HasSubstr("expected"));
  EXPECT_THAT(rejection("t,id,x,y\ns,,Mm,Mm\n0,1,3,4\n"), HasSubstr("a unit of length"));
  EXPECT_THAT(rejection("# unit: Mm\nid,t,x,y\n1,0,3,4\n"), HasSubstr("a unit of length"));
  EXPECT_THAT(rejection("# x in MM\nid,t,x,y\n1,0,3,4\n"), HasSubstr("a unit of length"));
  for (const char* header : {"ID,T,X [MM],Y [MM]", "id,t,X MM,Y MM", "ID,T,X_MM,POSY_MM",
                             "id,t,xMm,posYMm", "# UNIT: MM\nid,t,x,y"})
    EXPECT_EQ(first(fmt::format("{}\n1,0,3000,4000\n", header)), Eigen::Vector2d(3, 4)) << header;
  EXPECT_EQ(first("T,ID,X,Y\nS,,MM,MM\n0,1,3000,4000\n"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(read("ID,T [MS],X,Y\n1,0,3,4\n1,40,3,4\n")->facts().fps, 25);
}

TEST_F(RecordedUnits, TreatOtherWordsAsRemarks) {
  for (const char* header : {"id,time (UTC),x (head),y (head)", "id,t,x (left),y (left)",
                             "id,t,x (HEAD),y (centre of mass)", "id,t (since start),x,y",
                             "id,t,posX (world frame),posY (world-frame)", "id,t,x (smoothed),y",
                             "id t x (head) y (head)", "id,t,x (main),y (mean)",
                             "ID,TIME (GMT),X,Y", "id,t,x (raw) (head),y"}) {
    SCOPED_TRACE(header);
    const char separator = std::string_view(header).starts_with("id t") ? ' ' : ',';
    const auto recording =
        read(fmt::format("{0}\n1{1}0{1}3{1}4\n1{1}1{1}3{1}4\n", header, separator));
    EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(3, 4));
    ASSERT_EQ(recording->facts().anomalies.size(), 1u);
    EXPECT_THAT(recording->facts().anomalies[0].what, HasSubstr("treated as remarks"));
  }
  const auto noted = read("id,t,x (head),y (head)\n1,0,3,4\n1,1,3,4\n");
  EXPECT_EQ(noted->facts().anomalies[0].count, 2);
  EXPECT_EQ(noted->facts().anomalies[0].first, "'head' in the column 'x (head)'");
  EXPECT_EQ(first("id,t,x_cm (head),y_cm (head)\n1,0,300,400\n"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(first("# framerate: 25\n# unit: cm\n# id frame x (head) y (head)\n1 0 300 400\n"),
            Eigen::Vector2d(3, 4));
  EXPECT_THAT(rejection("id,time (UTC),x,y\n1,12:00:01,3,4\n"), HasSubstr("expected a number"));
  for (const char* unit : {"(px)",        "(pixels)",   "(furlongs)",   "(yards)",
                           "(miles)",     "(Meilen)",   "(mtr)",        "(pxl)",
                           "(Zoll)",      "(sekunden)", "(kilometros)", "(mtres)",
                           "(secnds)",    "(in heads)", "(Zentimeter)", "[head]",
                           "{head}",      "/head",      "/ head",       "(h2)",
                           "(ab)",        "(relative)", "(cells)",      "(pixel coordinates)",
                           "(head, px)",  "(voxels)",   "(decimetres)", "(grid units)",
                           "(left foot)", "(1)",        "(-)"}) {
    EXPECT_THAT(rejection(fmt::format("id;t;x {0};y {0}\n1;0;3;4\n", unit)),
                HasSubstr("expected a unit of length"))
        << unit;
  }
  for (const char* unit : {"(frames)", "(frame)", "(ticks)", "(steps)", "[UTC]", "/UTC", "(days)"})
    EXPECT_THAT(rejection(fmt::format("id,t {},x,y\n1,0,3,4\n", unit)), HasSubstr("a unit of time"))
        << unit;
}

TEST_F(RecordedUnits, AreOverriddenByOptionsWithANote) {
  const std::string text = "id,t,x [cm],y [px]\n1,0,3,4\n1,1,3,4\n";
  const auto recording = read(text, {.unit_m = 1});
  EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(3, 4));
  ASSERT_EQ(recording->facts().anomalies.size(), 1u);
  EXPECT_EQ(recording->facts().anomalies[0].what, "columns whose units --unit overrides");
  EXPECT_EQ(recording->facts().anomalies[0].count, 2);
  EXPECT_EQ(recording->facts().anomalies[0].first, "'cm' of the column 'x [cm]'");
  EXPECT_THAT(rejection(text, {.unit_m = 1, .strict = true}), HasSubstr("--unit overrides"));
  EXPECT_TRUE(
      read("id,t,x [cm],y [cm]\n1,0,3,4\n1,1,3,4\n", {.unit_m = 0.01})->facts().anomalies.empty())
      << "equal to the file";
  const auto archive =
      read("# framerate: 25\n# id frame x/cm y/cm\n1 0 3 4\n1 1 3 4\n", {.fps = 16, .unit_m = 1});
  ASSERT_EQ(archive->facts().anomalies.size(), 2u);
  EXPECT_THAT(archive->facts().anomalies[0].what, HasSubstr("--fps overrides"));
  EXPECT_THAT(archive->facts().anomalies[1].what, HasSubstr("--unit overrides"));
}

TEST_F(RecordedUnits, ApplyToTimes) {
  const std::pair<const char*, double> units[] = {{"s", 1},     {"ms", 1e-3}, {"us", 1e-6},
                                                  {"ns", 1e-9}, {"min", 60},  {"h", 3600}};
  for (const auto& [unit, in_s] : units)
    for (const char* name : {"t", "time", "Time", "simTime", "timestamp"})
      for (const char* spelling : kSpellings) {
        const std::string header = fmt::format("id,{},x,y\n", named(spelling, name, unit));
        SCOPED_TRACE(header);
        std::string text = header;
        for (int frame = 0; frame < 50; ++frame)
          text += fmt::format("1,{:.12g},{},0\n", 0.04 * frame / in_s, 0.05 * frame);
        const auto recording = read(text);
        EXPECT_EQ(recording->facts().fps, 25);
        EXPECT_EQ(recording->facts().duration_s, 49 / 25.0);
      }
  EXPECT_EQ(read("id,time (\xC2\xB5s),x,y\n1,0,0,0\n1,40000,0.05,0\n")->facts().fps, 25);
  EXPECT_EQ(read("id,timeMs,x,y\n1,0,0,0\n1,40,0.05,0\n")->facts().fps, 25);
  // 1e18 ns since 1970.
  std::string text = "id,timestamp_ns,x,y\n";
  for (int64_t frame = 0; frame < 50; ++frame)
    text += fmt::format("1,{},{},0\n", 1'700'000'000'000'000'000 + frame * 40'000'000,
                        0.05 * static_cast<double>(frame));
  EXPECT_EQ(read(text)->facts().fps, 25);
}

TEST_F(RecordedUnits, ApplyToHeadings) {
  const auto heading = [&](std::string_view name, double value, RecordingOptions options = {}) {
    return track(*read(fmt::format("id,t,x,y,{}\n1,0,3,4,0\n1,1,3,4,{}\n", name, value),
                       std::move(options)),
                 0)[1]
        .heading_rad;
  };
  const auto quarter = static_cast<float>(kTurn_rad / 4);
  for (const char* name :
       {"heading [deg]", "heading (degrees)", "heading/deg", "heading_deg", "heading [\xC2\xB0]",
        "heading\xC2\xB0", "Heading deg", "headingDeg", "heading (in degrees)", "heading [\xB0]"})
    EXPECT_FLOAT_EQ(heading(name, 90), quarter) << name;
  EXPECT_FLOAT_EQ(heading("heading [deg]", 1), static_cast<float>(kTurn_rad / 360));
  for (const char* name : {"heading", "heading_rad", "heading [rad]", "heading (radians)"})
    EXPECT_FLOAT_EQ(heading(name, 1.5), 1.5f) << name;
  EXPECT_FLOAT_EQ(heading("heading_rad", 99), 99) << "said to be rad";
  // Beyond a full turn a unit is required.
  const std::string text = "id,t,x,y,heading\n1,0,3,4,0\n1,1,3,4,90\n";
  EXPECT_THAT(rejection(text),
              AllOf(StartsWith("recording:3: expected headings from -2 pi to 2 pi rad"),
                    HasSubstr("found '90'"), HasSubstr("--heading-unit deg")));
  EXPECT_THAT(rejection("id,t,x,y,heading\n1,0,3,4,-7\n"), HasSubstr("found '-7'"));
  EXPECT_EQ(rejection("id,t,x,y,heading\n1,0,3,4,6.2832\n"), "") << "a turn, rounded";
  EXPECT_FLOAT_EQ(heading("heading", 90, {.heading_unit_rad = kTurn_rad / 360}), quarter);
  EXPECT_FLOAT_EQ(heading("heading", 90, {.heading_unit_rad = 1}), 90);
  EXPECT_FLOAT_EQ(heading("heading_deg", 90, {.columns = "heading=heading_deg"}), quarter);
  const auto overruled =
      read("id,t,x,y,heading [deg]\n1,0,3,4,1\n1,1,3,4,1\n", {.heading_unit_rad = 1});
  EXPECT_EQ(track(*overruled, 0)[0].heading_rad, 1);
  EXPECT_THAT(overruled->facts().anomalies.at(0).what, HasSubstr("--heading-unit overrides"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,3,4\n", {.heading_unit_rad = 1}),
              StartsWith("--heading-unit: expected a table with a column of headings"));
  EXPECT_THAT(rejection("# framerate: 25\n# id frame x/m y/m\n1 0 3 4\n", {.heading_unit_rad = 1}),
              StartsWith("--heading-unit: expected"));
}

TEST_F(RecordedUnits, AreReadFromALineOfUnits) {
  const std::string names = "\"t\",\"id\",\"name\",\"active\",\"x\",\"y\",\"z\"\n";
  const std::string row = "500,0,\"a\",1,300,4,0\n1000,0,\"a\",1,301,4,0\n";
  const auto read_with = [&](const std::string& units) { return read(names + units + row); };
  const auto mixed = read_with("\"ms\",\"\",\"\",\"\",\"cm\",\"m\",\"m\"\n");
  EXPECT_EQ(track(*mixed, 0)[0].position_m, Eigen::Vector2d(3, 4));
  EXPECT_EQ(mixed->facts().duration_s, 0.5);
  EXPECT_EQ(track(*read_with("[ms],-,-,-,[cm],(m),m\n"), 0)[0].position_m, Eigen::Vector2d(3, 4));
  EXPECT_THAT(rejection(names + "\"s\",\"\",\"\",\"\",\"px\",\"px\",\"\"\n" + row),
              AllOf(StartsWith("recording:2: expected a unit of length"), HasSubstr("'px'")));
  EXPECT_THAT(rejection(names + "\"blink\",\"\",\"\",\"\",\"m\",\"m\",\"\"\n" + row),
              AllOf(StartsWith("recording:2: expected a unit of time"), HasSubstr("'blink'")));
  EXPECT_THAT(rejection("t,id,x [cm],y\ns,,m,m\n0,0,3,4\n"),
              AllOf(StartsWith("recording:2: expected cm for x"), HasSubstr("found 'm'")));
}

}  // namespace
}  // namespace throng::units_test
