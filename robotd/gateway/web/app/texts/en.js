// Every text of the console in English. Names in braces are filled in.
export const en = {
  'page.drive': 'Drive', 'page.maps': 'Maps', 'page.recordings': 'Recordings', 'page.health': 'Health', 'page.log': 'Log', 'page.settings': 'Settings',
  'nav.label': 'Pages', 'nav.skip': 'Skip to the page',

  'sign.token': 'Token', 'sign.enter': 'Sign in', 'sign.how': 'A token is made on the robot: robotctl gateway token new NAME --role operator. Its address signs in by itself.',
  'sign.out': 'Sign out', 'sign.wrong': 'That did not sign in: {message}', 'sign.ended': 'The session has ended: sign in again. STOP still works for a day.',

  'where.unknown': 'nothing heard yet', 'where.no_map': 'no map', 'where.localized': 'localized', 'where.predicted': 'predicted', 'where.ambiguous': 'ambiguous: {places} places', 'where.ambiguous_beyond': 'ambiguous', 'where.lost': 'lost',
  'mode.disarmed': 'disarmed', 'mode.idle': 'armed, idle', 'mode.fault': 'fault', 'mode.mapping': 'mapping', 'mode.localizing': 'localizing', 'mode.driving': 'driving', 'mode.moving': 'moving', 'mode.turning': 'turning', 'mode.looking': 'looking', 'mode.scanning': 'scanning', 'mode.measuring': 'measuring', 'mode.exploring': 'exploring',
  'head.age': 'heard {age} ago', 'head.fresh': 'live', 'head.battery': '{volts} V', 'head.battery_unknown': 'battery unknown', 'head.unattended': 'UNATTENDED', 'head.stop_of': 'stop {stop} of {stops}', 'head.readings': '{taken} of {total} readings', 'head.held': 'held: {why}',

  'stop.ready': 'STOP', 'stop.stopping': 'STOPPING', 'stop.stopped': 'STOPPED in {ms} ms', 'stop.unconfirmed_short': 'NOT CONFIRMED',
  'stop.unconfirmed': 'STOP NOT CONFIRMED: use the emergency stop on the robot', 'stop.label': 'Software stop. Also: Escape, Space',

  'silent.page': 'nothing heard for {age}: this page has lost the gateway. It tries again by itself.',
  'silent.gateway': 'nothing heard for {age}: the gateway is silent.',
  'silent.daemon': 'nothing heard for {age}: the daemon is silent. On the robot: systemctl status robotd',
  'silent.daemon_never': 'the daemon has not been heard yet. On the robot: systemctl status robotd',
  'silent.base': 'no odometry for {age}: the base is silent.',
  'other_life': 'The daemon was started again: map, way and plan of before are gone from this page.', 'new_console': 'There is a newer console.', 'new_console.load': 'Load it',
  'hidden': 'You drive, and this page was hidden for {age}. A hidden page may fall silent, which stops the robot.', 'understood': 'Understood',

  'arm.title': 'Motion', 'arm.arm': 'Hold to arm', 'arm.disarm': 'Disarm', 'arm.clear': 'Clear faults', 'arm.will': 'Arms {devices}. Battery {battery}.', 'arm.none': 'no device',
  'arm.is_armed': 'The robot may move.', 'arm.is_disarmed': 'Nothing moves until it is armed.', 'arm.is_fault': 'A fault is latched: clear it first, then arm.',

  'why.silent': 'Nothing is heard from the robot.', 'why.viewer': 'You may look and stop.', 'why.no_fault': 'No fault is latched.', 'why.fault': 'A fault is latched.', 'why.armed': 'It is armed already.', 'why.no_device': 'No device answers.', 'why.disarmed': 'The robot is disarmed.', 'why.busy': 'A mission is under way.', 'why.no_map': 'No map is in use.', 'why.not_localized': 'It is not known where the robot is.',
  'remedy.silent': 'Wait, or look after it.', 'remedy.viewer': 'An operator may do more.', 'remedy.none': '', 'remedy.clear': 'Clear it first.', 'remedy.plug': 'Look after power and cables.', 'remedy.arm': 'Arm it first.', 'remedy.stop': 'Wait for it, or stop it.', 'remedy.load': 'Load one on the page Maps, or make one.', 'remedy.localize': 'Localize first.',

  'mission.title': 'Mission', 'mission.by_you': 'You drive.', 'mission.by': '{who} drives. You watch, and may stop.', 'mission.by_program': 'Another program drives. You may stop it.',
  'mission.take_over': 'Take over', 'mission.asked': '{who} wants to take over: {left} s', 'mission.give': 'Give', 'mission.keep': 'Keep', 'mission.asking': 'Asked {who}; yours in {left} s unless they keep it.',
  'mission.unattended': 'Goes on though nobody looks', 'mission.last': 'Last: {kind}, {phase}. {message}',
  'kind.map': 'make a map', 'kind.localize': 'localize', 'kind.drive': 'go to a place', 'kind.move': 'move', 'kind.turn': 'turn', 'kind.look': 'look', 'kind.scan': 'scan', 'kind.measure': 'measure', 'kind.explore': 'explore',
  'phase.started': 'started', 'phase.driving': 'driving', 'phase.sweeping': 'sweeping', 'phase.computing': 'computing', 'phase.done': 'done', 'phase.stopped': 'stopped', 'phase.failed': 'failed',

  'act.title': 'What to do', 'act.where': 'Where am I', 'act.where_hint': 'One sweep; all places and headings are tried.', 'act.here': 'Localize here', 'act.here_hint': 'Draw a disk on the map in which the robot is.', 'act.go': 'Go here', 'act.go_hint': 'Pick a place on the map, look at the way, press again.', 'act.map': 'Make a map', 'act.map_hint': 'Name it, click its stops in order.', 'act.explore': 'Explore', 'act.explore_hint': 'It looks for unseen ground and maps it.', 'act.cancel': 'Cancel', 'act.start': 'Start', 'act.go_now': 'Go', 'act.resume': 'Resume',
  'go.pick': 'Click the place on the map. By keys: arrows move the cross, Enter picks.', 'go.asking': 'Looking for a way…', 'go.length': '{length} to ({x}, {y}).', 'go.blind': 'To ({x}, {y}). The way is found when it sets out.', 'go.none': 'No way: {why}', 'go.nearest': 'Go to the nearest place: ({x}, {y})',
  'here.draw': 'Draw from the middle of the disk outwards. By keys: Enter on the map takes a disk of 1 m in the middle.', 'here.disk': 'A disk of {radius} round ({x}, {y}).',
  'explore.goes_on': 'It goes on with the map in use, from where the robot is believed to be.',
  'map.name': 'Name', 'map.stop': 'Stop {n}: ({x}, {y})', 'map.up': 'Earlier', 'map.down': 'Later', 'map.remove': 'Remove', 'map.stops_hint': 'Click stops on the map, in order. Without any, the robot maps from where it stands.', 'map.start': 'It begins at ({x}, {y}), heading {heading}.', 'map.start_zero': 'The robot stands at the origin of the new map, heading along x.', 'map.name_bad': '1 to 64 letters, digits, . - _, the first a letter or digit',

  'map.label': 'Map of the robot. Arrows move, plus and minus zoom, 0 shows all.', 'map.none': 'No map is in use.', 'map.none_hint': 'Make one, or load one on the page Maps.', 'map.follow': 'Follow', 'map.fit': 'Show all', 'map.in': 'Zoom in', 'map.out': 'Zoom out', 'map.free': 'free', 'map.wall': 'wall', 'map.unseen': 'never seen', 'map.layers': 'Layers',
  'layer.rank': 'Rank', 'layer.belief': 'Belief', 'layer.sweep': 'Sweep', 'layer.way': 'Way', 'layer.plan': 'Plan', 'layer.clearance': 'Clearance',
 

  'pose.title': 'Where it is', 'pose.at': '({x}, {y}), heading {heading}', 'pose.explained': '{rank} of {readings} readings explained', 'pose.regions': 'Places', 'pose.none': 'No place is believed.', 'pose.number': 'No', 'pose.place': 'Place', 'pose.belief': 'Belief', 'pose.rank': 'Explained', 'pose.left_out': 'and {count} more',

  'maps.title': 'Maps', 'maps.none': 'No map is stored.', 'maps.version': 'version {version}', 'maps.in_use': 'in use', 'maps.unsaved': 'not saved by anybody', 'maps.damaged': 'damaged: {damage}', 'maps.size': '{cols} × {rows} cells of {cell}', 'maps.load': 'Load', 'maps.picture': 'Picture', 'maps.older': '{count} older versions', 'maps.stops': '{count} stops',
  'maps.current': 'In use: {name}', 'maps.current_none': 'No map is in use.', 'maps.save': 'Save', 'maps.save_as': 'Save as', 'maps.discard': 'Give up changes', 'maps.not_saved': 'It has changes that nobody saved; they are kept as version {version}.', 'maps.not_kept': 'It has changes that are in memory alone: save them.', 'maps.loaded': 'In use: {name}. The robot does not know where it is on it: localize.', 'maps.saved': 'Saved as version {version}.',
  'maps.delete': 'Delete', 'maps.delete_sure': 'Type the name to delete it for good: {name}', 'maps.rename': 'Rename', 'maps.new_name': 'New name', 'maps.made': 'made {when}', 'maps.export': 'Export',
  'bring.title': 'A map of another program', 'bring.files': 'A yaml and its picture, both in a zip, or a picture alone', 'bring.resolution': 'Metres per pixel', 'bring.counts': '{free} free, {walls} walls, {unseen} never seen', 'bring.store': 'Store', 'bring.stored': '{name} is stored as version {version}. Load it to use it.',

  'rec.title': 'Recordings', 'rec.none': 'There are none.', 'rec.start': 'Start recording', 'rec.stop': 'Stop recording', 'rec.running': 'Recording to {path}', 'rec.not': 'Nothing is being recorded.', 'rec.file': 'File', 'rec.size': 'Size', 'rec.changed': 'Changed', 'rec.download': 'Download', 'rec.now': 'under way',

  'health.title': 'Health', 'health.why': 'What it can do now', 'health.can': 'It can {act}.', 'health.cannot': 'It cannot {act}: {why} {remedy}', 'health.arm': 'arm', 'health.localize': 'localize', 'health.drive': 'drive', 'health.lines': 'Lines', 'health.device': 'Device', 'health.link': 'Link', 'health.motion': 'Motion', 'health.rate': 'Frames/s', 'health.errors': 'Errors', 'health.retries': 'Retries', 'health.round': 'Round trip', 'health.clock': 'Clock', 'health.faults': 'Faults', 'health.armed': 'armed', 'health.disarmed': 'disarmed', 'health.curves': 'Last quarter of an hour', 'health.up': 'The daemon has been up for {age}.', 'health.dropped': 'Left out for this page, by topic: {topics}', 'health.none_dropped': 'No message was left out for this page.', 'health.detail': 'Detail', 'health.ms': '{ms} ms', 'health.ppm': '{ppm} ppm fast', 'health.ppm_slow': '{ppm} ppm slow', 'health.rates': 'Frames a second of each line', 'health.volts': 'Battery [V]',
  'link.ready': 'ready', 'link.absent': 'absent', 'link.connecting': 'connecting',

  'log.title': 'Log', 'log.level': 'From level', 'log.search': 'Search', 'log.pause': 'Pause', 'log.go_on': 'Go on', 'log.download': 'Download', 'log.shown': '{shown} of {all} lines', 'log.daemon': 'Daemon', 'log.audit': 'Who did what', 'log.lost': '{count} lines were left out for this page.', 'log.who': 'Who', 'log.whence': 'From', 'log.what': 'What', 'log.result': 'Result', 'log.when': 'When', 'log.source': 'Source', 'log.message': 'Message',

  'set.title': 'Settings', 'set.look': 'Look', 'set.theme': 'Theme', 'set.dark': 'Dark', 'set.light': 'Light', 'set.contrast': 'High contrast', 'set.you': 'You', 'set.you_are': '{name}, {role}', 'set.versions': 'Versions', 'set.gateway': 'Gateway {version}, console {console}', 'set.daemon': 'Daemon, session {session}', 'set.config': 'Effective configuration of the daemon', 'set.access': 'Who may come in', 'set.tokens': 'Tokens', 'set.sessions': 'Sessions', 'set.name': 'Name', 'set.role': 'Role', 'set.until': 'Until', 'set.forever': 'revoked', 'set.used_up': 'used up', 'set.seen': 'Last seen', 'set.pages': 'Open pages', 'set.ended': 'ended', 'set.licences': 'Licences of what is inside', 'set.keys': 'Keys', 'set.keys_text': 'Escape: STOP anywhere. Space: STOP outside of fields. Enter held: arm. G: go here. F: follow. 1 to 6: layers. On the map arrows move, + and - zoom, 0 shows all.',
  'fox.title': 'Foxglove', 'fox.hint': 'Its app shows map, sweeps and poses live. It can bring no token: give it an address, which lets it in once.', 'fox.ask': 'Make an address', 'fox.address': 'Open connection, Foxglove WebSocket, within two minutes',
  'role.viewer': 'viewer: may look and stop', 'role.operator': 'operator: may drive', 'role.admin': 'admin: may also delete',

  'done': 'Done.', 'refused': 'Refused: {message}', 'outcome_unknown': 'Outcome unknown: {message}', 'close': 'Close', 'cancel': 'Cancel',
};
