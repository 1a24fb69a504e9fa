// Foxglove's own client of its protocol, at a robot's gateway: says what it was told, as JSON.
import { FoxgloveClient } from '@foxglove/ws-protocol';

const [address, seconds] = process.argv.slice(2);
const told = { server: null, channels: {}, messages: {}, problems: [] };
const socket = new WebSocket(address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL, 'foxglove.sdk.v1']);
const client = new FoxgloveClient({ ws: socket });
const topics = new Map();
client.on('serverInfo', (info) => { told.server = info; });
client.on('status', (status) => told.problems.push(status.message));
client.on('error', (error) => told.problems.push(String(error)));
client.on('advertise', (channels) => {
  for (const channel of channels) {
    told.channels[channel.topic] = channel;
    topics.set(client.subscribe(channel.id), channel.topic);
  }
});
client.on('message', ({ subscriptionId, timestamp, data }) => {
  const topic = topics.get(subscriptionId);
  (told.messages[topic] ??= []).push({ timestamp: String(timestamp), content: JSON.parse(new TextDecoder().decode(data)) });
});
setTimeout(() => {
  told.protocol = socket.protocol;
  process.stdout.write(JSON.stringify(told), () => process.exit(0));
}, 1000 * Number(seconds));
