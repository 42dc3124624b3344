// The tracker's picture, while somebody looks at it.

import {find, pollWhileSeen, setText} from "./dom.js";
import {number} from "./format.js";

export class CameraPicture {
  constructor(stream) {
    const picture = find("camera-picture");
    let there = false;
    stream.on(
        "camera",
        (camera) => {
          there = camera.picture === true;
          find("show-camera-label").hidden = false;
          setText(
              find("camera-text"),
              `${camera.state ?? ""} ${camera.width_px ?? "?"} × ${camera.height_px ?? "?"} px, ` +
                  `${number(camera.fps)} pictures a second${
                      camera.trouble ? `; ${camera.trouble}` : ""}${there ? "" : "; no picture"}`);
          picture.hidden = !there;
        },
        () => {
          there = false;
          find("show-camera").checked = false;
          find("show-camera-label").hidden = find("camera").hidden = true;
        });
    find("show-camera").addEventListener("change", (event) => {
      find("camera").hidden = !event.target.checked;
    });
    let count = 0;
    pollWhileSeen(find("camera"), 200, async () => {
      if (!there || !stream.connected) return;
      count += 1;
      await new Promise((done) => {
        picture.onload = picture.onerror = done;
        picture.src =
            `/api/camera.jpg?n=${count}`;  // another address: else the browser shows the old one
      });
    });
  }
}
