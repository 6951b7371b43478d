// Surefoot's contacts and events while three.js plays a clip.
//
{{head}}
//
// import { SurefootEvents } from './surefoot_three.js';
// const gltf = await new GLTFLoader().loadAsync('hero_shove.glb');
// const action = mixer.clipAction(gltf.animations.at(-1));     // its userData.surefoot is the report
// const events = new SurefootEvents(mixer, action);            // of a .vrma: give the parsed .events.json as the third argument
// events.addEventListener('foot_down', ({ detail }) => step(detail.foot, detail.time));
// action.play();
// each frame: mixer.update(delta); events.update();            // and events.contact('left') while you need it

export class SurefootEvents extends EventTarget {
  /** `sidecar`: the parsed .events.json, for clips without userData. */
  constructor(mixer, action, sidecar = null) {
    super();
    const clip = action.getClip();
    this.report = clip.userData?.surefoot ?? sidecar?.[clip.name] ?? (sidecar && Object.values(sidecar)[0]);
    if (!this.report) throw new Error(`"${clip.name}" carries no surefoot report: give the .events.json beside it`);
    this.mixer = mixer;
    this.action = action;
    this.duration = clip.duration;
    this.moments = moments(this.report);
    this.onLoop = (event) => { if (event.action === action) this.loops += event.loopDelta; };
    mixer.addEventListener('loop', this.onLoop);
    this.rewind();
  }

  /** After a jump in time: nothing between is told, what stands at the present time is told at the next update. */
  rewind() {
    this.loops = 0;
    this.told = this.action.time - 1e-9;
  }

  /** Call it after mixer.update: dispatches what has happened since the last call. A clip that plays backwards is silent. */
  update() {
    const { time } = this.action;
    if (this.loops > 0) {
      this.tell(this.told, this.duration);
      for (let loop = 1; loop < this.loops; loop += 1) this.tell(-1, this.duration);
      this.tell(-1, time);
    } else if (this.loops === 0 && time > this.told) {
      this.tell(this.told, time);
    }
    this.loops = 0;
    this.told = time;
  }

  /** The contact that the foot ("{{left}}" or "{{right}}") is in now, or null: { foot, part, start, end, position, normal, ... }. */
  contact(foot, time = this.action.time) {
    return this.report.contacts.find((one) => one.foot === foot && one.start <= time && time < one.end) ?? null;
  }

  dispose() {
    this.mixer.removeEventListener('loop', this.onLoop);
  }

  /** What happens after `from`, until `to` and then. */
  tell(from, to) {
    for (const { type, detail } of this.moments) {
      if (detail.time > from && detail.time <= to) this.dispatchEvent(new CustomEvent(type, { detail }));
    }
  }
}

/** Everything with a time, in its order: { type, detail: { time, ... } }. */
function moments(report) {
  const list = report.events.map((event) => ({ type: event.name, detail: event }));
  for (const contact of report.contacts) {
    list.push({ type: 'contact_start', detail: { ...contact, time: contact.start } });
    list.push({ type: 'contact_end', detail: { ...contact, time: contact.end } });
  }
  return list.sort((a, b) => a.detail.time - b.detail.time);
}
