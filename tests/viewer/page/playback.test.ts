// Tests the clock of a recorded run.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {clock, Playback, since, SPEEDS, whenOf} from '../../../viewer/page/src/playback.ts';
import {socketUrl} from '../../../viewer/page/src/sources.ts';

function tenSeconds(): Playback {
  const playback = new Playback(1 / 60);
  playback.frames = 600;
  return playback;
}

test('a second of viewing plays a second of the run', () => {
  const playback = tenSeconds();
  for (let i = 0; i < 50; ++i) playback.advance(0.02);
  assert.equal(Math.round(playback.position), 60);
  assert.equal(playback.time_s.toFixed(1), '1.0');
});

test('changes the speed within its list', () => {
  const playback = tenSeconds();
  playback.change(1);
  assert.equal(playback.speed, 2);
  playback.advance(0.1);
  assert.equal(Math.round(playback.position), 12);
  for (let i = 0; i < 20; ++i) playback.change(-1);
  assert.equal(playback.speed, SPEEDS[0]);
  for (let i = 0; i < 20; ++i) playback.change(1);
  assert.equal(playback.speed, SPEEDS.at(-1));
});

test('stops at the end and restarts from the beginning', () => {
  const playback = tenSeconds();
  playback.seek(598);
  playback.advance(0.2);
  assert.equal(playback.frame, 599);
  assert.equal(playback.playing, false);
  playback.toggle();
  assert.equal(playback.frame, 0);
  assert.equal(playback.playing, true);
});

test('continues at the end known so far while the log is read', () => {
  const playback = tenSeconds();
  playback.seek(599);
  playback.advance(0.2, false);
  assert.equal(playback.playing, true);
  playback.frames = 1200;
  playback.advance(0.1, false);
  assert.ok(playback.frame > 600);
});

test('a step pauses and stays within the run', () => {
  const playback = tenSeconds();
  playback.step(1);
  assert.deepEqual([playback.frame, playback.playing], [1, false]);
  playback.step(-5);
  assert.equal(playback.frame, 0);
  playback.step(10_000);
  assert.equal(playback.frame, 599);
});

test('a suspended tab continues where it was', () => {
  const playback = tenSeconds();
  playback.advance(3600);
  assert.ok(playback.frame <= 15, `jumped to frame ${playback.frame}`);
});

test('formats times', () => {
  assert.equal(clock(0), '0:00.00');
  assert.equal(clock(62.5), '1:02.50');
  assert.equal(clock(59.996), '1:00.00');
  assert.equal(clock(3599.999), '60:00.00');
});

test('formats since when a contact lasts', () => {
  assert.equal(since(30, 30, 1 / 60), '0.00 s');
  assert.equal(since(30, 93, 1 / 60), '1.05 s');
  assert.equal(since(~634, 700, 1 / 60), 'before 10.57 s');
  assert.equal(since(~0, 700, 1 / 60), 'before 0.00 s');
});

test('formats when a contact was', () => {
  const contact = {begin: 634, end: 667, isOlder: false, isLost: false};
  assert.equal(whenOf(contact, 700, 1 / 60), '10.57-11.12 s (0.55 s)');
  assert.equal(whenOf({...contact, end: -1}, 666, 1 / 60), 'from 10.57 s (at least 0.55 s)');
  assert.equal(whenOf({...contact, isOlder: true}, 700, 1 / 60), 'before 10.57-11.12 s (at least 0.55 s)');
});

test('the socket has the path and the security of the page', () => {
  assert.equal(socketUrl('http://127.0.0.1:7684/'), 'ws://127.0.0.1:7684/ws');
  assert.equal(socketUrl('http://127.0.0.1:7684/#frame=3'), 'ws://127.0.0.1:7684/ws');
  assert.equal(socketUrl('https://hub/user/x/proxy/8090/?token=1#camera=1/2'), 'wss://hub/user/x/proxy/8090/ws');
});
