!> A slave node tied by mortar where bodies move far: all directions, turning with the slave.
!>
!> The row of the shape at the start is kept: what it averages is always the same material. With its
!> shares s (sum 0) the tie says sum s x = Q a: a is what the sum was at the start in a frame of one
!> slave facet at the node, Q that frame now. Bodies that fit have a = 0.
module lopin_tie_element
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, dual_width, variable, dual_cross, dual_norm, &
      & operator(+), operator(-), operator(*), operator(/), assignment(=)
   use lopin_vectors, only : cross
   use lopin_cells, only : shape_functions
   use lopin_facets, only : facets_type, facet_rule_type
   use lopin_dofs, only : dofs_type
   use lopin_contact_row, only : point_state_type, point_law_type, contact_status
   use lopin_local_matrix, only : local_matrix_type
   implicit none
   private
   public :: tie_type, new_tie, evaluate_tie, facet_normal

   type :: tie_type
      logical :: set = .false.
      integer, allocatable :: node(:)
      real(wp), allocatable :: share(:)        !! of each; their sum is 0 [-]
      real(wp), allocatable :: along(:, :)     !! (ndim-1, nodes) tangents of the frame's facet
      real(wp) :: weight = 0.0_wp              !! D [area]
      real(wp) :: offset(3) = 0.0_wp           !! a [length]
      logical :: apart = .false.               !! a is more than the rounding of coordinates
   end type tie_type

   !> Offsets below this share of the facets are the rounding of coordinates.
   real(wp), parameter :: rounding = 1.0e-9_wp
   real(wp), parameter :: unity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
      & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

   subroutine new_tie(self, slave_node, node, coefficient, weight, facets, rules, x)
      type(tie_type), intent(out) :: self
      integer, intent(in) :: slave_node
      integer, intent(in) :: node(:)
      real(wp), intent(in) :: coefficient(:), weight    !! of the row [area]
      type(facets_type), intent(in) :: facets           !! of the slave
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)                   !! (ndim, nnode) [length]
      real(wp) :: n(8), dn(size(x, 1) - 1, 8)
      type(dual_type) :: place(3, size(node)), frame(3, 3)
      real(wp) :: size_
      logical :: kept(size(node))
      integer :: i, k, m, at, d

      d = size(x, 1)
      i = facet_of(facets, slave_node, node)
      m = facets%nnode(i)
      kept = [(any(facets%node(:m, i) == node(k)), k=1, size(node))]
      kept = kept .or. abs(coefficient) > 0.0_wp
      self%node = pack(node, kept)
      self%share = pack(coefficient, kept)/weight
      self%weight = weight
      allocate (self%along(d - 1, size(self%node)), source=0.0_wp)
      at = findloc(facets%node(:m, i), slave_node, 1)
      associate (cell => rules(facets%cell(i))%cell)
         call shape_functions(cell, cell%xi(:d - 1, at), n(:m), dn(:, :m))
      end associate
      do k = 1, m
         self%along(:, findloc(self%node, facets%node(k, i), 1)) = dn(:, k)
      end do
      place = 0.0_wp
      place(:d, :size(self%node))%v = x(:, self%node)
      call lay_frame(self, place(:, :size(self%node)), frame)
      do k = 1, 3
         self%offset(k) = dot_product(frame(:d, k)%v, matmul(x(:, self%node), self%share))
      end do
      size_ = 0.0_wp
      do k = 1, size(self%node)
         size_ = max(size_, norm2(x(:, self%node(k)) - x(:, self%node(1))))
      end do
      self%apart = norm2(self%offset) > rounding*size_
      self%set = .true.
   end subroutine new_tie

   !> A facet at a node, with all its nodes in a list.
   pure integer function facet_of(facets, slave_node, node) result(i)
      type(facets_type), intent(in) :: facets
      integer, intent(in) :: slave_node, node(:)
      integer :: k

      do i = 1, facets%n
         associate (own => facets%node(:facets%nnode(i), i))
            if (.not. any(own == slave_node)) cycle
            if (all([(any(node == own(k)), k=1, size(own))])) return
         end associate
      end do
   end function facet_of

   !> Normal of the frame's facet where nodes stand.
   pure function facet_normal(self, x) result(normal)
      type(tie_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp) :: normal(size(x, 1)), t(3, 2)
      integer :: m, k

      t = 0.0_wp
      do m = 1, size(self%node)
         do k = 1, size(self%along, 1)
            t(:size(x, 1), k) = t(:size(x, 1), k) + self%along(k, m)*x(:, self%node(m))
         end do
      end do
      if (size(x, 1) == 2) then
         normal = [t(2, 1), -t(1, 1)]
      else
         normal = cross(t(:, 1), t(:, 2))
      end if
      normal = normal/norm2(normal)
   end function facet_normal

   !> Columns: along the facet, across (in space), outward.
   subroutine lay_frame(self, place, frame)
      type(tie_type), intent(in) :: self
      type(dual_type), intent(in) :: place(:, :)
      type(dual_type), intent(out) :: frame(3, 3)
      type(dual_type) :: t(3, 2)
      integer :: m, k, i

      t = 0.0_wp
      do m = 1, size(self%node)
         do k = 1, size(self%along, 1)
            if (.not. abs(self%along(k, m)) > 0.0_wp) cycle
            do i = 1, 3
               t(i, k) = t(i, k) + self%along(k, m)*place(i, m)
            end do
         end do
      end do
      call frame_of(t, size(self%along, 1), frame)
   end subroutine lay_frame

   !> The frame of two tangents; in the plane of the first alone.
   pure subroutine frame_of(t, n, frame)
      type(dual_type), intent(inout) :: t(3, 2)
      integer, intent(in) :: n                 !! tangents of the facet
      type(dual_type), intent(out) :: frame(3, 3)
      type(dual_type) :: length
      integer :: i

      ! In the plane the second tangent is the axis that looks at the reader, turned round.
      if (n == 1) t(3, 2)%v = -1.0_wp
      frame(:, 3) = dual_cross(t(:, 2), t(:, 1))
      if (n == 2) frame(:, 3) = dual_cross(t(:, 1), t(:, 2))
      length = dual_norm(t(:, 1))
      do i = 1, 3
         frame(i, 1) = t(i, 1)/length
      end do
      length = dual_norm(frame(:, 3))
      do i = 1, 3
         frame(i, 3) = frame(i, 3)/length
      end do
      frame(:, 2) = dual_cross(frame(:, 3), frame(:, 1))
   end subroutine frame_of

   !> How the force of an arm turns with its frame: second slopes of force . (Q offset) by the
   !> tangents of the frame's facet, from exact first slopes by differences of the fourth order in a
   !> thousandth of the tangents (an error of 1e-12).
   pure function turning_slopes(tangent, offset, force) result(second)
      real(wp), intent(in) :: tangent(:, :)    !! (ndim, ndim-1) [length]
      real(wp), intent(in) :: offset(3)        !! [length]
      real(wp), intent(in) :: force(3)         !! [stress]
      real(wp) :: second(size(tangent), size(tangent))
      real(wp), parameter :: at(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      real(wp) :: moved(size(tangent, 1), size(tangent, 2)), step
      integer :: i, k, s

      step = 1.0e-3_wp*norm2(tangent)
      second = 0.0_wp
      do k = 1, size(tangent, 2)
         do i = 1, size(tangent, 1)
            do s = 1, 4
               moved = tangent
               moved(i, k) = moved(i, k) + at(s)*step
               second(:, i + (k - 1)*size(tangent, 1)) = second(:, i + (k - 1)*size(tangent, 1)) &
                  & + share(s)/step*first_slopes(moved)
            end do
         end do
      end do

   contains

      pure function first_slopes(tangent) result(slope)
         real(wp), intent(in) :: tangent(:, :)
         real(wp) :: slope(size(tangent))
         type(dual_type) :: t(3, 2), frame(3, 3), value
         integer :: i, j

         t = 0.0_wp
         do j = 1, size(tangent, 2)
            do i = 1, size(tangent, 1)
               t(i, j) = variable(tangent(i, j), i + (j - 1)*size(tangent, 1))
            end do
         end do
         call frame_of(t, size(tangent, 2), frame)
         value = 0.0_wp
         do j = 1, 3
            do i = 1, size(tangent, 1)
               value = value + (force(i)*offset(j))*frame(i, j)
            end do
         end do
         slope = value%d(:size(slope))
      end function first_slopes
   end function turning_slopes

   !> Forces and exact tangent, as evaluate_point of lopin_contact_element.
   subroutine evaluate_tie(state, local, self, dofs, x, law)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(tie_type), intent(in) :: self
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present places [length]
      type(point_law_type), intent(in) :: law
      type(dual_type) :: apart(3), frame(3, 3)
      real(wp) :: c                            !! [stress/length]
      real(wp), allocatable :: slope(:, :)     !! (d, local dofs) of the row
      integer :: input(size(x, 1), size(self%node)), from, width, i, m, d, n

      d = size(x, 1)
      c = law%enforcement%c
      call list_inputs()
      n = size(local%dof)
      allocate (slope(d, n), source=0.0_wp)
      do from = 0, merge(local%nu - 1, 0, law%with_tangent .or. self%apart), dual_width
         call part(from)
         width = min(dual_width, local%nu - from)
         do i = 1, d
            slope(i, from + 1:from + width) = apart(i)%d(:width)
         end do
      end do
      state%row = 0.0_wp
      state%row(:d) = apart(:d)%v
      state%traction = 0.0_wp
      state%traction(:d) = law%lambda(:d) - c*apart(:d)%v
      if (law%enforcement%partly) then
         ! Where supports hold the node there is no traction, and its multiplier goes to zero.
         state%traction(:d) = matmul(law%enforcement%held(:d, :d), state%traction(:d))
         state%row(:d) = (law%lambda(:d) - state%traction(:d))/c
         slope = matmul(law%enforcement%held(:d, :d), slope)
      end if
      state%normal = -frame(:, 3)%v
      state%gap = dot_product(state%normal(:d), apart(:d)%v)
      if (law%enforcement%partly) state%gap = dot_product(state%normal(:d), &
         & matmul(law%enforcement%held(:d, :d), apart(:d)%v))
      state%slip = 0.0_wp
      state%status = contact_status%stick
      state%weight = self%weight
      state%force = spread(0.0_wp, 1, local%nu)
      if (self%apart) then
         ! The arm between the sides turns with the frame: its moment falls on the frame's facet.
         state%force = self%weight*matmul(state%traction(:d), slope(:, :local%nu))
      else
         do m = 1, size(self%node)
            do i = 1, d
               if (input(i, m) > 0) state%force(input(i, m)) = self%weight*self%share(m) &
                  & *state%traction(i)
            end do
         end do
      end if
      if (law%with_tangent) call make_matrix()

   contains

      subroutine list_inputs()
         integer :: free(size(input)), k, j

         local%nu = 0
         input = 0
         do j = 1, size(self%node)
            do k = 1, d
               if (dofs%id(k, self%node(j)) == 0) cycle
               local%nu = local%nu + 1
               free(local%nu) = dofs%id(k, self%node(j))
               input(k, j) = local%nu
            end do
         end do
         local%dof = [free(:local%nu), (dofs%n + law%first_row + k, k=0, d - 1)]
      end subroutine list_inputs

      !> What the two sides are apart beyond the offset, with slopes by inputs from + 1 and on.
      subroutine part(from)
         integer, intent(in) :: from
         type(dual_type) :: place(3, size(self%node))
         integer :: k, j

         place = 0.0_wp
         apart = 0.0_wp
         do j = 1, size(self%node)
            do k = 1, d
               place(k, j) = variable(x(k, self%node(j)), merge(input(k, j) - from, 0, &
                  & input(k, j) > 0))
               apart(k) = apart(k) + self%share(j)*place(k, j)
            end do
         end do
         call lay_frame(self, place, frame)
         do j = 1, 3
            do k = 1, d
               apart(k) = apart(k) - self%offset(j)*frame(k, j)
            end do
         end do
      end subroutine part

      subroutine make_matrix()
         integer :: j, k

         associate (nu => local%nu)
            if (allocated(local%k)) deallocate (local%k)
            if (allocated(local%spring)) deallocate (local%spring)
            if (allocated(local%flat_row)) deallocate (local%flat_row)
            if (allocated(local%reach)) deallocate (local%reach)
            allocate (local%k(n, n), local%spring(nu, nu), source=0.0_wp)
            do j = 1, size(self%node)
               do k = 1, d
                  if (input(k, j) == 0) cycle
                  local%k(input(k, j), :nu) = self%weight*self%share(j)*c*slope(k, :nu)
                  local%k(input(k, j), nu + k) = -self%weight*self%share(j)
                  if (law%enforcement%partly) local%k(input(k, j), nu + 1:) = &
                     & -self%weight*self%share(j) *law%enforcement%held(k, :d)
               end do
            end do
            if (self%apart) then
               local%k(:nu, :nu) = self%weight*c*matmul(transpose(slope(:, :nu)), &
                  & slope(:, :nu))
               local%k(:nu, nu + 1:) = -self%weight*transpose(slope(:, :nu))
               call turn_arm(local%k(:nu, :nu))
            end if
            local%k(nu + 1:, :nu) = slope(:, :nu)
            if (law%enforcement%partly) local%k(nu + 1:, nu + 1:) = (unity(:d, :d) &
               & - law%enforcement%held(:d, :d))/c
            local%spring = self%weight*c*matmul(transpose(slope(:, :nu)), slope(:, :nu))
            if (law%enforcement%partly) return
            local%reach = slope(:, :nu)
            local%stiff = self%weight*c*unity(:d, :d)
            local%firm = local%stiff
         end associate
      end subroutine make_matrix

      !> The arm turns with the places of its frame's nodes.
      subroutine turn_arm(k)
         real(wp), intent(inout) :: k(:, :)    !! (nu, nu)
         real(wp) :: tangent(d, d - 1), second(d*(d - 1), d*(d - 1)), chain(d*(d - 1), size(k, 1))
         real(wp) :: turned(d*(d - 1), size(k, 1))
         integer :: j, i, m

         tangent = 0.0_wp
         chain = 0.0_wp
         do j = 1, size(self%node)
            do m = 1, d - 1
               tangent(:, m) = tangent(:, m) + self%along(m, j)*x(:, self%node(j))
               do i = 1, d
                  if (input(i, j) > 0) chain(i + (m - 1)*d, input(i, j)) = self%along(m, j)
               end do
            end do
         end do
         second = turning_slopes(tangent, self%offset, state%traction)
         turned = matmul(second, chain)
         do j = 1, size(k, 2)
            do i = 1, size(k, 1)
               k(i, j) = k(i, j) + self%weight*dot_product(chain(:, i), turned(:, j))
            end do
         end do
      end subroutine turn_arm
   end subroutine evaluate_tie
end module lopin_tie_element
