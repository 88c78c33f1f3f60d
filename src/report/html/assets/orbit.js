// What all WebGL 2 views share: the eye on its orbit, and programs out of their texts.

// A view that pointer and keys turn; `changed` draws it again.
class Orbit {
  constructor(canvas, view, changed) {
    Object.assign(this, view);
    this.changed = changed;
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (last === null) return;
      this.turn((last[0] - event.clientX) / 120, (event.clientY - last[1]) / 120);
      last = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    const zooms = { "+": 1.1, "=": 1.1, "-": 1 / 1.1 };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (zooms[event.key]) {
      this.zoom = Math.min(Math.max(this.zoom * zooms[event.key], 0.4), 4);
      this.changed();
    } else return;
    event.preventDefault();
  }

  turn(azimuth, height) {
    this.azimuth += azimuth;
    this.height = Math.min(Math.max(this.height + height, this.lowest ?? 0.03), 1.55);
    this.changed();
  }

  // Right, up and towards the eye.
  axes() {
    const towards = direction(Math.PI / 2 - this.height, this.azimuth);
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    const up = [-towards[2] * right[1], towards[2] * right[0], towards[0] * right[1] - towards[1] * right[0]];
    return { right, up, towards };
  }
}

// `first` is the name of the attribute 0, where there is one.
function program(gl, vertex, fragment, first = null) {
  const made = gl.createProgram();
  if (first) gl.bindAttribLocation(made, 0, first);
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}
