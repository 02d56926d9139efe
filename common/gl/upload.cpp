#include "gl/upload.h"

#include "base/check.h"
#include "gl/bindings.h"

namespace quincunx::gl {

void upload(const Texture2D& texture, int x, int y, const Image& image) {
    QX_CHECK_EQ(image.channels, 4);
    QX_CHECK(x >= 0 && y >= 0 && x + image.width <= texture.width() && y + image.height <= texture.height());
    detail::bindTextureForEditing(texture.get());
    glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, image.width, image.height, GL_RGBA, GL_FLOAT, image.data.data());
}

}  // namespace quincunx::gl
