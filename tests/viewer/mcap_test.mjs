// Reads the output of `throng export` with the reference reader: node mcap_test.mjs NPM_FOLDER THRONG
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import path from 'node:path';

const [npm, throng] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(npm), 'package.json'));
const {McapIndexedReader, McapStreamReader} = require('@mcap/core');
const {decompress} = require('fzstd');
const decompressHandlers = {zstd: (bytes) => decompress(bytes)};

/** A file in memory with the interface that the reader expects. */
class Bytes {
  constructor(bytes) {
    this.bytes = bytes;
  }
  async size() {
    return BigInt(this.bytes.byteLength);
  }
  async read(offset, length) {
    return new Uint8Array(this.bytes.buffer, this.bytes.byteOffset + Number(offset), Number(length));
  }
}

const folder = mkdtempSync(path.join(tmpdir(), 'mcap'));
const run = (...words) => execFileSync(throng, words, {cwd: folder, encoding: 'utf8', maxBuffer: 1 << 28});
try {
  run('run', 'bottleneck', '--avatars', '60', '--seconds', '14', '--lcm', 'off', '--log', 'a.lcmlog');
  run('export', 'a.lcmlog', '--mcap', 'a.mcap', '--poses-hz', '2');
  const checked = run('check', 'a.lcmlog');
  const [, begins, ends] = checked.match(/events\s+(\d+) begin, (\d+) end/).map(Number);
  assert.ok(begins > 20, 'a log without contacts shows nothing');

  const bytes = readFileSync(path.join(folder, 'a.mcap'));
  const reader = await McapIndexedReader.Initialize({readable: new Bytes(bytes), decompressHandlers});
  const topics = new Map([...reader.channelsById].map(([id, channel]) => [id, channel.topic]));
  const counts = new Map(), kinds = {begin: 0, end: 0}, times = new Map();
  const known = new Set(['world']), entities = new Set(), used = new Set();
  for await (const message of reader.readMessages()) {
    const topic = topics.get(message.channelId);
    const json = JSON.parse(new TextDecoder().decode(message.data));
    counts.set(topic, (counts.get(topic) ?? 0) + 1);
    assert.ok(message.logTime >= (times.get(topic) ?? 0n), `${topic} in order`);
    times.set(topic, message.logTime);
    if (topic === '/contacts') kinds[json.kind]++;
    if (topic === '/tf')
      for (const transform of json.transforms) {
        known.add(transform.child_frame_id);
        const {x, y, z, w} = transform.rotation;
        assert.ok(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-4, 'a rotation');
      }
    if (topic === '/scene') {
      for (const deletion of json.deletions) assert.ok(entities.delete(deletion.id), deletion.id);
      for (const entity of json.entities) {
        entities.add(entity.id);
        used.add(entity.frame_id);
        const [shape] = entity.triangles;
        assert.ok(Math.max(...shape.indices) < shape.points.length, 'indices in range');
      }
    }
  }
  assert.ok(entities.size < used.size, 'an entity of a person who left remains');
  for (const frame of used) assert.ok(known.has(frame), `no transform for ${frame}`);
  assert.deepEqual(kinds, {begin: begins, end: ends}, 'as many contacts as the log has');
  assert.equal(counts.get('/tf'), 28, 'two poses per second');
  assert.ok(used.size > 60 * 10, 'a mesh for each part');
  assert.equal(reader.statistics.messageCount, BigInt([...counts.values()].reduce((a, b) => a + b)));

  // Reads record after record and checks every checksum.
  const stream = new McapStreamReader({validateCrcs: true, decompressHandlers});
  stream.append(bytes);
  let messages = 0n, last;
  for (let record; (record = stream.nextRecord());) {
    if (record.type === 'Message') messages++;
    last = record.type;
  }
  assert.equal(messages, reader.statistics.messageCount);
  assert.equal(last, 'Footer');
  assert.ok(stream.done());

  const events = run('export', 'a.lcmlog', '--csv', 'events').trim().split('\n');
  assert.equal(events.length, 1 + begins + ends, 'one row per event');
  assert.match(events[0], /^frame,time_s,kind,body_a,body_b,name_a,name_b,part_a,part_b,level$/);
  const states = run('export', 'a.lcmlog', '--csv', 'THRONG_STATES').trim().split('\n');
  assert.equal(states.length > 60 * 100, true);
  console.log(`${bytes.byteLength} bytes, ${messages} messages, ${begins} begins, ${ends} ends`);
} finally {
  rmSync(folder, {recursive: true});
}
