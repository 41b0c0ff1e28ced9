// A video beside the 3-D view: the browser plays it, its clock leads while it plays, and a slider sets when it begins.
"use strict";

const EARLIEST = 0.02; // s before a video's end at which its last picture is over
const WITHIN = 1e-4; // s into a picture, so that a rounded time does not show the one before
const NETWORK = 2; // MediaError.MEDIA_ERR_NETWORK

class TrialVideo {
  // place: the element to fill; trial: session, trial, and videos (mbkf/app/videos.py); player: the trial's; say: of the strip.
  constructor(place, trial, player, say) {
    const { files, video, version, shown } = trial.videos;
    Object.assign(this, { place, trial, player, files, list: video, shown: null, fault: false });
    this.saving = new Saving("videos?" + new URLSearchParams({ session: trial.session, trial: trial.trial }), "video", { video, version }, {
      say, take: (theirs) => { this.list = theirs; this.show(theirs[0] || null); },
      saved: () => word("video_saved"), overtaken: (theirs) => word("video_overtaken", theirs.map((one) => one.file).join(", ") || "–"),
    });
    this.build();
    this.chooser();
    player.leader = this;
    this.show(shown);
  }

  build() {
    this.video = element("video", { muted: true, playsInline: true, preload: "auto", disablePictureInPicture: true });
    this.video.setAttribute("aria-label", word("video"));
    this.video.onerror = () => this.failed(this.video.error && this.video.error.code === NETWORK ? "video_lost" : "video_codec");
    this.video.onloadedmetadata = () => this.ready();
    this.note = element("p", { className: "note", role: "status" });
    this.slider = element("input", { type: "range", step: 0.01, id: "begins", ariaLabel: word("video_begins") });
    this.number = element("input", { type: "number", step: 0.01, id: "begins-s", ariaLabel: word("video_begins") });
    this.slider.oninput = () => this.begin(Number(this.slider.value));
    this.number.onchange = () => { if (this.number.value !== "") this.begin(Number(this.number.value)); };
    this.slider.onkeydown = (event) => { if (event.key.startsWith("Arrow")) event.stopPropagation(); }; // the player's own arrows
    const row = element("div", { className: "row", title: word("video_hint") }, element("label", { htmlFor: "begins" }, word("video_begins")), this.slider, this.number, " s");
    this.place.append(element("div", { className: "picture" }, this.video, this.note), row);
  }

  chooser() {
    this.chosen = element("select", { id: "video", title: word("video_hint"), onchange: () => this.choose(this.chosen.value) },
      new Option(word(this.files.length ? "no_video" : "no_videos"), ""), ...this.files.map((name) => new Option(name, name)));
    this.chosen.disabled = !this.files.length;
    this.player.clock.parentElement.append(element("span", { className: "choice" }, element("label", { htmlFor: "video" }, word("video")), this.chosen));
  }

  // The chosen file is the first of the list from then on; "" hides the video in this page alone.
  choose(name) {
    if (!name) return this.show(null);
    const known = this.list.find((one) => one.file === name) || { file: name, begins_s: 0 };
    this.keep(known);
    this.show(known);
  }

  keep(one) {
    this.list = [one, ...this.list.filter(({ file }) => file !== one.file)];
    this.saving.soon(() => this.list);
  }

  show(one) {
    [this.shown, this.fault] = [one, false];
    this.place.hidden = one === null;
    this.chosen.value = one ? one.file : "";
    this.note.textContent = "";
    this.place.dataset.state = "waiting";
    if (!one) {
      this.video.removeAttribute("src");
      this.video.load();
      return;
    }
    this.video.src = "video?" + new URLSearchParams({ session: this.trial.session, file: one.file });
    this.range();
  }

  failed(reason) {
    if (!this.shown) return;
    this.fault = true;
    this.place.dataset.state = "fault";
    this.note.textContent = word(reason, this.shown.file);
  }

  ready() {
    if (!this.video.videoWidth) return this.failed("video_codec"); // sound alone: the picture's coding is unknown
    this.range();
    this.video.playbackRate = this.player.speed;
    this.go(this.player.time);
  }

  // The slider reaches from a video that ends where the trial begins to one that begins where it ends.
  range() {
    const { times, frames } = this.player.recording, length = Number.isFinite(this.video.duration) ? this.video.duration : 60;
    [this.slider.min, this.slider.max] = [Math.floor(times[0] - length), Math.ceil(times[frames - 1])];
    this.slider.value = this.shown.begins_s;
    this.number.value = this.shown.begins_s.toFixed(2);
  }

  begin(time) {
    this.keep({ file: this.shown.file, begins_s: Math.round(100 * time) / 100 });
    this.shown = this.list[0];
    this.slider.value = this.shown.begins_s;
    this.number.value = this.shown.begins_s.toFixed(2);
    this.go(this.player.time);
  }

  get usable() {
    return this.shown !== null && !this.fault && this.video.readyState >= HTMLMediaElement.HAVE_METADATA;
  }

  // True where the video has a picture of a time of the trial; else the view says so.
  covers(time) {
    const at = time - this.shown.begins_s, inside = at >= 0 && !(at > this.video.duration - EARLIEST);
    this.place.dataset.state = inside ? "shown" : "outside";
    this.note.textContent = inside ? "" : word(at < 0 ? "video_before" : "video_after");
    return inside;
  }

  // Somebody chose a time of the trial.
  go(time) {
    if (!this.usable) return;
    if (this.covers(time)) this.video.currentTime = time - this.shown.begins_s + WITHIN;
    else this.video.pause();
  }

  play(on, speed) {
    this.video.playbackRate = speed;
    if (!on) {
      this.video.pause();
      this.go(this.player.time);
    }
  }

  // The trial's time by the video's clock, while the player plays at this time; null where no video plays.
  // A video that is still being read holds the trial at its time.
  clock(time) {
    if (!this.usable) return null;
    const video = this.video;
    if (!this.covers(time) || video.ended) {
      video.pause();
      return null;
    }
    if (video.paused) {
      video.currentTime = time - this.shown.begins_s + WITHIN;
      video.play().catch(() => {}); // a pause before it has begun
    }
    const runs = !video.seeking && video.readyState > HTMLMediaElement.HAVE_CURRENT_DATA;
    return runs ? Math.max(time, video.currentTime + this.shown.begins_s) : time;
  }
}
