// The constants of steering, each with its unit and reason.
// One rule: a number that shapes how people walk stands here, nowhere else.
#pragma once

#include <algorithm>

namespace throng::tuning {

/// What grows between two of these numbers: 0 up to `from`, 1 from `to` on.
inline double share_between(double from, double to, double x) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

/// Decisions ten times a second: people do not react faster, and between them motion is smooth.
inline constexpr double kPeriod_s = 0.1;
/// Two people at 1.34 m/s head on meet from 5.4 m within the horizon.
inline constexpr double kReach_m = 5.0;
/// People speed up a little to pass.
inline constexpr double kHaste = 1.2;
/// Time to take up a wanted velocity (Helbing and Molnar 1995: 0.5 s).
inline constexpr double kRelaxation_s = 0.5;
/// Breaks the symmetry of people who meet exactly head on.
inline constexpr double kPerturbation_mps = 1e-3;
/// Whoever wants less than this wants nowhere: what breaks symmetry is below it. In the densest
/// throng people still want this much.
inline constexpr double kWish_mps = 0.01;
/// Centres stay this far from walls whatever happens; steering itself keeps a disc's radius.
inline constexpr double kWallGap_m = 0.1;
/// Companions walk beside each other where both together are faster than this, their discs farther
/// apart than the second.
inline constexpr double kBeside_mps = 0.3;
inline constexpr double kBesideGap_m = 0.14;
/// An audience looks to its stage give or take this; nobody farther off than the other.
inline constexpr double kFacing_rad = 0.1;
inline constexpr double kMostFacing_rad = 0.25;
/// People who wait before a closed door stand so far apart beyond their discs, behind whoever is
/// ahead within 60 degrees (the cosine), slow down over the next length, and stand rather than
/// walk slower than that share of their speed.
inline constexpr double kWaits_m = 0.05;
inline constexpr double kBehind = 0.5;
inline constexpr double kBrakes_m = 1.6;
inline constexpr double kCreeps = 0.08;
/// Whoever made no progress for so long tries another way past, each time for about a second.
inline constexpr double kStuck_s = 1.5;
/// Others begin to make way for who has been stuck so long, and do all the way after so long.
inline constexpr double kUrgeFrom_s = 0.5;
inline constexpr double kUrgeTo_s = 3.5;
/// How far the velocity that such a one shows to others goes over to the one wanted.
inline constexpr double kShownIntent = 0.85;
/// How far to a side such a try goes, at most, as a multiple of the way ahead.
inline constexpr double kSidestep = 2.0;
/// Whoever was held up for so long begins to follow more closely those who walk off ahead, does so
/// wholly after so long, and no more once it has walked for the third. Doors carry 60 % more people
/// than a single file at its best: one headway for both there is not.
inline constexpr double kEagerFrom_s = 2.0;
inline constexpr double kEagerTo_s = 5.0;
inline constexpr double kEagerFor_s = 25.0;
/// A target counts as reached within this; after so long in the goal's area, anyhow.
inline constexpr double kArrival_m = 0.7;
inline constexpr double kPatience_s = 3.0;
/// Round a goal with no side longer than the first agents hinder each other or walk in circles (the
/// heuristic does round a square of 0.6 m, and hits one of 0.8 m): its area then is all within the
/// second of it.
inline constexpr double kSmallGoal_m = 0.7;
inline constexpr double kAroundSmall_m = 1.0;

/// The shortest way is the same for all, and round a corner all would walk in one file along its
/// inner edge. Each keeps to a side of their own, as far off the shortest way as the next wall is
/// farther away than the first, and than the second's share of the way left. Not so in a queue,
/// where it would lead into a door's frame: all of it from the fourth's share of the free speed
/// on, nothing below the third's. So fast they go over to it: feet can follow.
inline constexpr double kOwnSideFrom_m = 0.45;
inline constexpr double kOwnSideShare = 0.2;
inline constexpr double kOwnSideSlow = 0.2, kOwnSideFast = 0.5;
inline constexpr double kOwnSideRate_mps = 0.2;

/// Ways bend round where a crowd is slow: where it is denser than the first, and all the more up to
/// the second, a metre counts longer by the share of the free speed at which people get on along
/// the way, but none is taken for slower than the third. Who stands in such a crowd bends less and
/// less: at full density people follow the way as it is, or they would swing before a door and mix
/// two streams. What is seen once a second counts by so much, the rest is what was seen before.
/// People mind the delay by a factor of their own between the last two. Only where there is room
/// beside somebody does a way bend: all of it where walls are as far as the second of these,
/// nothing nearer than the first, or people would walk along the walls.
inline constexpr double kSlowFrom_per_m2 = 0.7;
inline constexpr double kSlowTo_per_m2 = 1.5;
inline constexpr double kSlowest = 0.15;
inline constexpr double kCrowdingNew = 0.3;
inline constexpr double kLeastMinded = 0.5;
inline constexpr double kMostMinded = 1.5;
inline constexpr double kBendsFrom_m = 0.5, kBendsWholly_m = 1.2;
/// Among people of two ways those who come towards one are passed up to the first density, and in
/// the way like those who stand from the second on.
inline constexpr double kBlockedFrom_per_m2 = 1.3, kBlockedTo_per_m2 = 2.0;

/// Of several exits people take the one where they expect to be through first, and look again once
/// a second, some at each decision. They change to another if it is better by this share of the
/// time and by their own patience besides: what they see of a queue is rough, and an exit that
/// seems a little better now is not in a second.
inline constexpr uint32_t kLooksAgain = 10;
inline constexpr double kBetter = 0.15;
inline constexpr double kLeastPatience_s = 2;
inline constexpr double kMostPatience_s = 20;
/// What people take a metre of an exit to let through a second, before they have seen: what doors
/// do in experiments.
inline constexpr double kExitFlow_per_ms = 1.9;
/// Where that many queue, what came through lately is what the exit lets through, over about so
/// long; the first guess counts as so many seconds of it. Nothing is taken for shut for good.
inline constexpr uint32_t kQueues = 5;
inline constexpr double kSeen_s = 20;
inline constexpr double kGuessed_s = 3;
inline constexpr double kLeastFlow_per_s = 0.1;

/// Whoever walks slower than this share of the free speed, with somebody of the same way ahead at
/// this gap or less, queues.
inline constexpr double kQueueSpeed = 0.4;
inline constexpr double kQueueGap_m = 0.4;

}  // namespace throng::tuning
