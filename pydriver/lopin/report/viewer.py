"""The picture of a page that moves: a canvas, a slider over time, a choice of fields, turning by
the mouse in 3D. Plain JavaScript, no network, no WebGL."""

SCRIPT = r"""
(function () {
  const stops = [[68,1,84],[59,82,139],[33,145,140],[94,201,98],[253,231,37]];
  const statusColours = ["#d9d9d9", "#0072b2", "#d55e00", "#cc79a7"];
  function unpack(text) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    const words = new Uint16Array(bytes.buffer), out = new Float32Array(words.length);
    for (let i = 0; i < words.length; ++i) out[i] = words[i]/65535;
    return out;
  }
  function edge(faces, p) {
    let sum = 0;
    faces.forEach(f => { let s = 0; for (let k = 0; k < 3; ++k) s += (p[3*f[0] + k] - p[3*f[f.length
      - 1] + k])**2; sum += Math.sqrt(s); });
    return sum/(faces.length || 1);
  }
  function colour(t) {
    const x = Math.max(0, Math.min(1, t))*(stops.length - 1), k = Math.min(stops.length - 2,
      Math.floor(x));
    const c = stops[k].map((v, i) => Math.round(v + (x - k)*(stops[k + 1][i] - v)));
    return "rgb(" + c.join(",") + ")";
  }
  function show(root) {
    const data = JSON.parse(root.querySelector("script").textContent);
    const canvas = root.querySelector("canvas"), pen = canvas.getContext("2d");
    const slider = root.querySelector("input[type=range]"), choice = root.querySelector("select");
    const said = root.querySelector(".time"), scale = root.querySelector(".scale");
    const flat = data.dimensions === 2, tools = root.querySelector(".tools");
    tools.checked = flat;
    const own = root.querySelector(".own"), value = root.querySelector(".value");
    let yaw = -0.6, pitch = 0.45, zoom = 1, pan = [0, 0], held = null, near = [];
    data.parts.forEach(part => {
      part.places = part.places.map(unpack);
      part.edge = edge(part.meshes[0], part.places[0]);
      for (const name in part.fields) part.fields[name].data = part.fields[name].data.map(unpack);
    });
    const names = [];
    data.parts.forEach(part => { for (const name in part.fields) if (!names.includes(name))
      names.push(name); });
    names.forEach(name => { const o = document.createElement("option"); o.textContent = name;
      choice.append(o); });
    const last = data.times.length - 1;
    const pressed = data.parts.some(part => { const f = part.fields["contact pressure"];
      return f && f.data[last].some(v => f.min + v*(f.max - f.min) > 1e-4*f.max); });
    const first = [pressed ? "contact pressure" : "plastic strain", "plastic strain",
      "von Mises stress", "displacement"].find(name => names.includes(name));
    if (first) choice.value = first;
    function project(p, i, c, s) {
      const x = p[3*i] - c[0], y = p[3*i + 1] - c[1], z = p[3*i + 2] - c[2];
      if (flat) return [x, -y, 0];
      const a = Math.cos(yaw), b = Math.sin(yaw), u = a*x + b*y, v = -b*x + a*y;
      const d = Math.cos(pitch), e = Math.sin(pitch);
      return [u, -(d*z + e*v), d*v - e*z];
    }
    const low = [1, 1, 1], high = [0, 0, 0];
    data.parts.forEach(part => { if (part.kind !== "tool") part.places.forEach(p => {
      for (let i = 0; i < p.length; ++i) { const k = i % 3; if (p[i] < low[k]) low[k] = p[i]; if
        (p[i] > high[k]) high[k] = p[i]; } }); });
    const centre = low.map((v, i) => (v + high[i])/2);
    const box = [];
    for (let i = 0; i < 8; ++i) box.push(project([i & 1 ? high[0] : low[0], i & 2 ? high[1] :
      low[1], i & 4 ? high[2] : low[2]], 0, centre));
    const spread = k => Math.max(...box.map(q => q[k])) - Math.min(...box.map(q => q[k]));
    const wide = spread(0), tall = spread(1);
    const scaling = () => 0.86*zoom*Math.min(canvas.width/(wide || 1), canvas.height/(tall || 1));
    function draw() {
      const frame = +slider.value, name = choice.value, w = canvas.width, h = canvas.height;
      const fit = scaling();
      near = [];
      pen.fillStyle = "#ffffff"; pen.fillRect(0, 0, w, h);
      said.textContent = "time " + data.times[frame].toPrecision(6).replace(/\.?0+$/, "");
      let least = Infinity, most = -Infinity;
      data.parts.forEach(part => { const f = part.fields[name]; if (f) { least = Math.min(least,
        f.min); most = Math.max(most, f.max); } });
      if (own.checked) {
        let a = Infinity, b = -Infinity;
        data.parts.forEach(part => { const f = part.fields[name]; if (f) f.data[frame].forEach(v =>
          { v = f.min + v*(f.max - f.min); a = Math.min(a, v); b = Math.max(b, v); }); });
        least = a; most = b;
      }
      const isStatus = name === "contact status", jobs = [];
      const ofContact = data.parts.some(part => part.kind === "contact" && part.fields[name]);
      data.parts.forEach(part => {
        if (part.kind === "tool" && !tools.checked) return;
        if (part.kind === "contact" && !ofContact) return;
        const p = part.places[frame], f = part.fields[name], at = [];
        const n = p.length/3;
        for (let i = 0; i < n; ++i) { const q = project(p, i, centre); at.push([w/2 + pan[0]
          + fit*q[0], h/2 + pan[1] + fit*q[1], q[2]]); }
        const values = f ? Array.from(f.data[frame], v => f.min + v*(f.max - f.min)) : null;
        if (values) at.forEach((q, i) => near.push([q, values[i], p, i]));
        const dense = fit*part.edge < 5;
        part.meshes[part.mesh[frame]].forEach(face => {
          let depth = 0, mean = 0, worst = 0;
          face.forEach(k => { depth += at[k][2]; if (values) { mean += values[k]; worst =
            Math.max(worst, Math.round(values[k])); } });
          depth /= face.length; mean /= face.length;
          let fill = part.kind === "tool" ? "#b8bfc8" : part.kind === "contact" ? "#8899aa" :
            "#dfe6ee";
          if (values) fill = isStatus ? statusColours[Math.max(0, Math.min(3, worst))] :
            colour((mean - least)/((most - least) || 1));
          jobs.push([depth - (part.kind === "contact" ? 1e-3 : 0), face, at, fill, part.kind,
            dense]);
        });
      });
      // A map of contact lies between bodies: they are drawn faintly, and it above them.
      const above = job => job[4] === "contact" ? 1 : 0;
      jobs.sort((a, b) => flat || ofContact ? above(a) - above(b) || b[0] - a[0] : b[0] - a[0]);
      jobs.forEach(([depth, face, at, fill, kind, dense]) => {
        if (face.length < 2) {
          pen.fillStyle = fill; pen.beginPath();
          pen.arc(at[face[0]][0], at[face[0]][1], 3, 0, 7); pen.fill(); return;
        }
        pen.beginPath(); face.forEach((k, i) => i ? pen.lineTo(at[k][0], at[k][1]) :
          pen.moveTo(at[k][0], at[k][1]));
        if (face.length === 2) {
          pen.strokeStyle = fill; pen.lineWidth = kind === "contact" ? 5 : 2.5; pen.stroke();
        } else {
          const faint = !flat && ofContact && kind !== "contact";
          pen.globalAlpha = faint ? 0.3 : 1;
          pen.closePath(); pen.fillStyle = fill; pen.fill();
          pen.strokeStyle = dense ? fill : "rgba(40,50,60,0.35)";
          pen.lineWidth = 0.6; pen.stroke();
          pen.globalAlpha = 1;
        }
      });
      if (isStatus) scale.innerHTML = ["open", "stick", "slip", "tied"].map((t, i) =>
        "<i style='background:" + statusColours[i] + "'></i>" + t).join(" ");
      else if (name) scale.innerHTML = least.toPrecision(4) + " <b></b> " + most.toPrecision(4);
      root.dataset.drawn = jobs.length;
    }
    slider.max = last; slider.value = slider.max;
    slider.oninput = choice.onchange = tools.onchange = own.onchange = draw;
    // The box of what is in contact at this time fills the canvas; without contact, the whole.
    function toContact() {
      const found = [], frame = +slider.value;
      data.parts.forEach(part => { const f = part.fields["contact status"]; if (f) f.data[frame].
        forEach((v, i) => { if (f.min + v*(f.max - f.min) > 0.5) found.push(project(
          part.places[frame], i, centre)); }); });
      zoom = 1; pan = [0, 0];
      if (!found.length) return draw();
      const range = k => [Math.min(...found.map(q => q[k])), Math.max(...found.map(q => q[k]))];
      const [a, b] = range(0), [c, d] = range(1), fit = scaling();
      const floor = 0.04*Math.max(wide, tall);
      zoom = 0.7*Math.min(canvas.width/(fit*Math.max(b - a, floor)),
        canvas.height/(fit*Math.max(d - c, floor)));
      const now = scaling();
      pan = [-now*(a + b)/2, -now*(c + d)/2]; draw();
    }
    root.querySelector(".close").onclick = toContact;
    root.querySelector(".whole").onclick = () => { zoom = 1; pan = [0, 0]; draw(); };
    canvas.onmousedown = e => { held = [e.clientX, e.clientY]; };
    window.addEventListener("mouseup", () => { held = null; });
    window.addEventListener("mousemove", e => {
      if (!held) return;
      const dx = e.clientX - held[0], dy = e.clientY - held[1];
      const pixel = canvas.width/canvas.getBoundingClientRect().width;
      if (flat || e.shiftKey) pan = [pan[0] + pixel*dx, pan[1] + pixel*dy];
      else { yaw += dx*0.01; pitch += dy*0.01; }
      held = [e.clientX, e.clientY]; draw();
    });
    function under(e) {
      const b = canvas.getBoundingClientRect(), pixel = canvas.width/b.width;
      return [(e.clientX - b.left)*pixel, (e.clientY - b.top)*pixel];
    }
    canvas.addEventListener("mousemove", e => {
      const m = under(e);
      let best = null, least = 144;
      near.forEach(one => { const d = (one[0][0] - m[0])**2 + (one[0][1] - m[1])**2;
        if (d < least) { least = d; best = one; } });
      value.textContent = best ? best[1].toPrecision(5) + " at (" + data.low.slice(0,
        data.dimensions).map((v, k) => (v + data.size*best[2][3*best[3] + k]).toPrecision(5)).
        join(", ") + ")" : "";
    });
    canvas.onwheel = e => {
      e.preventDefault();
      const m = under(e), grow = Math.exp(-e.deltaY*0.001);
      const x = m[0] - canvas.width/2, y = m[1] - canvas.height/2;
      pan = [x - grow*(x - pan[0]), y - grow*(y - pan[1])]; zoom *= grow; draw();
    };
    let timer = null;
    root.querySelector(".play").onclick = () => {
      if (timer) { clearInterval(timer); timer = null; return; }
      timer = setInterval(() => { slider.value = (+slider.value + 1) % data.times.length; draw();
        }, 120);
    };
    draw();
  }
  document.querySelectorAll(".viewer").forEach(show);
})();
"""
