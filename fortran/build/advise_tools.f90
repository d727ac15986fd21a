!> Advice on rigid tools of facets that are a plane, a sphere or a cylinder.
!>
!> Exact: all corners of the facets lie on one, to rounding of single precision, as STL files have,
!> and no slave comes near a place where they end: those surfaces have no holes and no rims.
module lopin_advise_tools
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_dense, only : symmetric_eigen, cholesky, cholesky_solve
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_tool_facets, only : facets_tool_type
   use lopin_tool_ends, only : tool_ends_type, new_tool_ends, slave_reaches
   use lopin_model, only : model_type, surface_of
   implicit none
   private
   public :: advise_tools

   !> Corners nearer than this share of the extent are on the surface.
   real(wp), parameter :: on_it = 1.0e-5_wp
   !> Chords of a round surface stand off it by less than this share of its radius: 37 degrees.
   real(wp), parameter :: deepest = 0.05_wp
   !> A surface of fewer facets is cheap as it is.
   integer, parameter :: least_facets = 8

   !> Corners of a tool, and the longest edge of a facet.
   type :: facets_type
      integer :: n = 0
      real(wp), allocatable :: x(:, :)         !! (ndim, corners) [length]
      real(wp) :: edge = 0.0_wp                !! [length]
      real(wp), allocatable :: middle(:, :)    !! (ndim, edges) their middles [length]
      type(tool_ends_type) :: ends
   end type facets_type

contains

   subroutine advise_tools(model)
      type(model_type), intent(inout) :: model
      type(cell_type), allocatable :: cell(:)
      type(facets_type) :: facets
      character(len=:), allocatable :: text
      logical :: told(size(model%surface))
      real(wp) :: radius
      integer :: p

      told = .false.
      call cells_of_words(model%element_word, cell)
      do p = 1, size(model%pair)
         associate (master => model%pair(p)%master)
            if (master == 0) cycle
            if (told(master)) cycle
            told(master) = .true.
            call take_facets(facets, model, cell, master)
            if (facets%n < least_facets) cycle
            call fit(facets, model%mesh%ndim, text, radius)
            if (len(text) == 0) cycle
            if (slave_reaches(model, master, facets%ends, facets%x)) cycle
            call model%log%say(severity%note, 'N0366', 'the '//to_text(facets%n)//' facets of '// &
               & model%surface(master)%name//' are '//text, model%pair(p)%at, &
               & help='an analytic *RIGID BODY has no facets to search'//sag(facets, radius))
         end associate
      end do
   end subroutine advise_tools

   !> How far facets stand off a round surface.
   function sag(facets, radius) result(text)
      type(facets_type), intent(in) :: facets
      real(wp), intent(in) :: radius           !! 0: a plane [length]
      character(len=:), allocatable :: text

      text = ''
      if (radius > 0.0_wp) text = ', and no chords, which stand off by up to '// &
         & to_text(facets%edge**2/(8.0_wp*radius), 2)
   end function sag

   !> Corners of a master that is rigid; none of others.
   subroutine take_facets(facets, model, cell, surface)
      type(facets_type), intent(out) :: facets
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      integer, intent(in) :: surface

      associate (s => model%surface(surface))
         if (s%kind == surface_of%faces) then
            if (any(model%mesh%section(s%element) > 0)) return
            call take_faces(facets, model, cell, s%element, s%face)
         else if (s%kind == surface_of%tool) then
            select type (tool => model%tool(s%tool)%shape)
            class is (facets_tool_type)
               facets%n = tool%mesh%nfacet
               facets%x = tool%mesh%x
               allocate (facets%middle(3, 3*facets%n))
               call measure_edges(facets, tool%mesh%x, tool%mesh%vertex, 0)
               call new_tool_ends(facets%ends, tool%mesh%x, tool%mesh%vertex)
            end select
         end if
      end associate
   end subroutine take_facets

   subroutine take_faces(facets, model, cell, element, face)
      type(facets_type), intent(inout) :: facets
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      integer, intent(in) :: element(:), face(:)
      logical :: used(model%mesh%nnode)
      integer :: i, n, edges, corner(4, size(element))

      used = .false.
      facets%n = size(element)
      allocate (facets%middle(model%mesh%ndim, 4*facets%n))
      edges = 0
      corner = 0
      do i = 1, size(element)
         associate (c => cell(model%mesh%etype(element(i))))
            n = c%face_nnode(face(i))
            associate (node => model%mesh%conn(c%face_node(:n, face(i)), element(i)))
               used(node) = .true.
               if (n > 2) n = merge(3, 4, n == 3 .or. n == 6)
               if (n == 3 .and. model%mesh%ndim == 2) n = 2
               call measure_edges(facets, model%mesh%x, reshape(node(:n), [n, 1]), edges)
               corner(:n, i) = node(:n)
               edges = edges + n
            end associate
         end associate
      end do
      facets%x = model%mesh%x(:, pack([(i, i=1, model%mesh%nnode)], used))
      facets%middle = facets%middle(:, :edges)
      call new_tool_ends(facets%ends, model%mesh%x, corner)
   end subroutine take_faces

   !> Lengths and middles of the edges of facets, behind `before` others.
   subroutine measure_edges(facets, x, corner, before)
      type(facets_type), intent(inout) :: facets
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: corner(:, :)      !! (corners, facets)
      integer, intent(in) :: before
      integer :: i, k, n

      n = size(corner, 1)
      do i = 1, size(corner, 2)
         do k = 1, n
            associate (a => x(:, corner(k, i)), b => x(:, corner(1 + mod(k, n), i)))
               facets%edge = max(facets%edge, norm2(a - b))
               facets%middle(:, before + n*(i - 1) + k) = 0.5_wp*(a + b)
            end associate
         end do
      end do
   end subroutine measure_edges

   !> What the corners lie on; '' if on none of these.
   subroutine fit(facets, ndim, text, radius)
      type(facets_type), intent(in) :: facets
      integer, intent(in) :: ndim
      character(len=:), allocatable, intent(out) :: text
      real(wp), intent(out) :: radius          !! 0: a plane [length]
      real(wp) :: centre(ndim)
      integer :: axis, k
      logical :: fits

      text = ''
      radius = 0.0_wp
      if (is_flat(facets%x)) then
         text = trim(merge('a straight line', 'a plane        ', ndim == 2))
         return
      end if
      call fit_ball(facets%x, facets%middle, centre, radius, fits)
      if (fits) then
         text = trim(merge('a circle', 'a sphere', ndim == 2))//' of radius '// &
            & to_text(radius, 6)//' about '//place(centre)
         return
      end if
      if (ndim == 2) return
      do axis = 1, 3
         associate (across => pack([1, 2, 3], [(k /= axis, k=1, 3)]))
            call fit_ball(facets%x(across, :), facets%middle(across, :), centre(:2), radius, fits)
            if (.not. fits) cycle
            text = 'a cylinder of radius '//to_text(radius, 6)//' along '// &
               & trim(merge('x', merge('y', 'z', axis == 2), axis == 1))//' through '// &
               & place(centre(:2))//' across it'
            return
         end associate
      end do
   end subroutine fit

   function place(x) result(text)
      real(wp), intent(in) :: x(:)
      character(len=:), allocatable :: text
      integer :: k

      text = to_text(x(1), 4)
      do k = 2, size(x)
         text = text//', '//to_text(x(k), 4)
      end do
   end function place

   !> All corners are on a line (2D) or a plane: their inertia vanishes in one direction.
   logical function is_flat(x)
      real(wp), intent(in) :: x(:, :)
      real(wp) :: middle(size(x, 1)), a(size(x, 1), size(x, 1)), value(size(x, 1))
      integer :: i, status

      middle = sum(x, dim=2)/size(x, 2)
      a = 0.0_wp
      do i = 1, size(x, 2)
         a = a + spread(x(:, i) - middle, 2, size(x, 1))*spread(x(:, i) - middle, 1, size(x, 1))
      end do
      call symmetric_eigen(a, value, status)
      is_flat = status == 0
      if (is_flat) is_flat = maxval(abs(matmul(a(:, 1), x - spread(middle, 2, size(x, 2))))) &
         & <= on_it*maxval(maxval(x, dim=2) - minval(x, dim=2))
   end function is_flat

   !> The ball |x|^2 = 2 c x + d that is nearest to the corners, and whether all are on it, and the
   !> middles of the edges near it: a box has its corners on a ball, too.
   subroutine fit_ball(x, middle_of, centre, radius, fits)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: middle_of(:, :)
      real(wp), intent(out) :: centre(:)
      real(wp), intent(out) :: radius
      logical, intent(out) :: fits
      real(wp) :: middle(size(x, 1)), row(size(x, 1) + 1), a(size(x, 1) + 1, size(x, 1) + 1), &
         & right(size(x, 1) + 1), extent
      integer :: i, n, status

      n = size(x, 1)
      middle = sum(x, dim=2)/size(x, 2)
      extent = maxval(maxval(x, dim=2) - minval(x, dim=2))
      a = 0.0_wp
      right = 0.0_wp
      do i = 1, size(x, 2)
         row = [2.0_wp*(x(:, i) - middle)/extent, 1.0_wp]
         a = a + spread(row, 2, n + 1)*spread(row, 1, n + 1)
         right = right + row*sum(((x(:, i) - middle)/extent)**2)
      end do
      centre = middle
      radius = 0.0_wp
      call cholesky(a, status)
      fits = status == 0
      if (.not. fits) return
      call cholesky_solve(a, right)
      centre = middle + extent*right(:n)
      radius = extent*sqrt(max(0.0_wp, right(n + 1) + sum(right(:n)**2)))
      do i = 1, size(x, 2)
         fits = fits .and. abs(norm2(x(:, i) - centre) - radius) <= on_it*extent
      end do
      do i = 1, size(middle_of, 2)
         fits = fits .and. norm2(middle_of(:, i) - centre) >= (1.0_wp - deepest)*radius
      end do
      where (abs(centre) < 1.0e-9_wp*extent) centre = 0.0_wp
      ! Of a shallow cap a plane and any ball are near.
      fits = fits .and. radius < 10.0_wp*extent
   end subroutine fit_ball
end module lopin_advise_tools
