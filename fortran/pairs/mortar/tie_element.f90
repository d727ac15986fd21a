!> A slave node tied by mortar where bodies move far: all directions, turning with the slave.
!>
!> The row of the shape at the start is kept: what it averages is always the same material. With its
!> shares s (sum 0) the tie says sum s x = Q a: a is what the sum was at the start in a frame of one
!> slave facet at the node, Q that frame now. Bodies that fit have a = 0.
module lopin_tie_element
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, dual_cross, dual_norm, &
      & operator(+), operator(-), operator(*), operator(/), assignment(=)
   use lopin_vectors, only : cross
   use lopin_cells, only : shape_functions
   use lopin_facets, only : facets_type, facet_rule_type
   use lopin_dofs, only : dofs_type
   use lopin_contact_row, only : point_state_type, point_law_type, contact_status
   use lopin_local_matrix, only : local_matrix_type, glue_type
   implicit none
   private
   public :: tie_type, new_tie, evaluate_tie, facet_normal

   type :: tie_type
      logical :: set = .false.
      integer, allocatable :: node(:)
      integer :: slave = 0                     !! its node in that list
      real(wp), allocatable :: share(:)        !! of each; their sum is 0 [-]
      real(wp), allocatable :: along(:, :)     !! (ndim-1, nodes) tangents of the frame's facet
      real(wp) :: weight = 0.0_wp              !! D [area]
      real(wp) :: offset(3) = 0.0_wp           !! a [length]
      logical :: apart = .false.               !! a is more than the rounding of coordinates
      logical :: near = .false.                !! and small beside the facets
   end type tie_type

   !> Offsets below this share of the facets are the rounding of coordinates.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> And below this they are small: iterations mend what a factor without arms leaves.
   real(wp), parameter :: close = 0.05_wp
   !> Projectors along the axes, up to rounding.
   real(wp), parameter :: aligned = 1.0e-12_wp
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
      type(dual_type) :: arm(3), frame(3, 3)
      real(wp) :: size_
      logical :: kept(size(node))
      integer :: i, k, m, at, d

      d = size(x, 1)
      i = facet_of(facets, slave_node, node)
      m = facets%nnode(i)
      kept = [(any(facets%node(:m, i) == node(k)), k=1, size(node))]
      kept = kept .or. abs(coefficient) > 0.0_wp
      self%node = pack(node, kept)
      self%slave = findloc(self%node, slave_node, 1)
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
      call find_arm(tangents(self, x), self%offset, arm, frame)
      do k = 1, 3
         self%offset(k) = dot_product(frame(:d, k)%v, matmul(x(:, self%node), self%share))
      end do
      size_ = 0.0_wp
      do k = 1, size(self%node)
         size_ = max(size_, norm2(x(:, self%node(k)) - x(:, self%node(1))))
      end do
      self%apart = norm2(self%offset) > rounding*size_
      self%near = norm2(self%offset) < close*size_
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

   !> Tangents of the frame's facet where nodes stand.
   pure function tangents(self, x) result(t)
      type(tie_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp) :: t(size(x, 1), size(x, 1) - 1)
      integer :: m, k

      t = 0.0_wp
      do m = 1, size(self%node)
         do k = 1, size(t, 2)
            t(:, k) = t(:, k) + self%along(k, m)*x(:, self%node(m))
         end do
      end do
   end function tangents

   !> Normal of the frame's facet where nodes stand.
   pure function facet_normal(self, x) result(normal)
      type(tie_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp) :: normal(size(x, 1)), t(3, 2)

      t = 0.0_wp
      t(:size(x, 1), :size(x, 1) - 1) = tangents(self, x)
      if (size(x, 1) == 2) then
         normal = [t(2, 1), -t(1, 1)]
      else
         normal = cross(t(:, 1), t(:, 2))
      end if
      normal = normal/norm2(normal)
   end function facet_normal

   !> The frame of two tangents; in the plane of the first alone. Columns: along the facet, across
   !> (in space), outward.
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

   !> The arm between the sides, Q offset, with slopes by the tangents of the frame's facet.
   pure subroutine find_arm(tangent, offset, arm, frame)
      real(wp), intent(in) :: tangent(:, :)    !! (ndim, ndim-1) [length]
      real(wp), intent(in) :: offset(3)        !! [length]
      type(dual_type), intent(out) :: arm(3), frame(3, 3)
      type(dual_type) :: t(3, 2)
      integer :: i, j, d

      d = size(tangent, 1)
      t = 0.0_wp
      do j = 1, d - 1
         do i = 1, d
            t(i, j) = variable(tangent(i, j), i + (j - 1)*d)
         end do
      end do
      call frame_of(t, d - 1, frame)
      arm = 0.0_wp
      do j = 1, 3
         do i = 1, d
            arm(i) = arm(i) + offset(j)*frame(i, j)
         end do
      end do
   end subroutine find_arm

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
      type(dual_type) :: arm(3), frame(3, 3)
      integer :: i, k, s, j

      step = 1.0e-3_wp*norm2(tangent)
      second = 0.0_wp
      do k = 1, size(tangent, 2)
         do i = 1, size(tangent, 1)
            do s = 1, 4
               moved = tangent
               moved(i, k) = moved(i, k) + at(s)*step
               call find_arm(moved, offset, arm, frame)
               j = i + (k - 1)*size(tangent, 1)
               second(:, j) = second(:, j) + share(s)/step*along_force(arm)
            end do
         end do
      end do

   contains

      !> Slopes of the arm along the force.
      pure function along_force(arm) result(slope)
         type(dual_type), intent(in) :: arm(3)
         real(wp) :: slope(size(tangent))
         integer :: j

         slope = 0.0_wp
         do j = 1, size(tangent, 1)
            slope = slope + force(j)*arm(j)%d(:size(tangent))
         end do
      end function along_force
   end function turning_slopes

   !> Forces and exact tangent, as evaluate_point of lopin_contact_element.
   subroutine evaluate_tie(state, local, self, dofs, x, law)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(tie_type), intent(in) :: self
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present places [length]
      type(point_law_type), intent(in) :: law
      type(dual_type) :: arm(3), frame(3, 3)
      real(wp) :: c                            !! [stress/length]
      real(wp) :: apart(size(x, 1))            !! sides beyond the offset [length]
      real(wp), allocatable :: slope(:, :), along(:, :)   !! (, nu) of these and of the tangents
      real(wp) :: tangent(size(x, 1), size(x, 1) - 1)     !! of the frame's facet [length]
      integer :: input(size(x, 1), size(self%node)), i, m, d

      d = size(x, 1)
      c = law%enforcement%c
      call list_inputs()
      tangent = tangents(self, x)
      call find_arm(tangent, self%offset, arm, frame)
      apart = -arm(:d)%v
      do m = 1, size(self%node)
         apart = apart + self%share(m)*x(:, self%node(m))
      end do
      allocate (slope(d, local%nu))
      call take_shares(slope)
      if (self%apart) call take_arm(slope)
      state%row = 0.0_wp
      state%row(:d) = apart
      state%traction = 0.0_wp
      state%traction(:d) = law%lambda(:d) - c*apart
      if (law%enforcement%partly) then
         ! Where supports hold the node there is no traction, and its multiplier goes to zero.
         state%traction(:d) = matmul(law%enforcement%held(:d, :d), state%traction(:d))
         state%row(:d) = (law%lambda(:d) - state%traction(:d))/c
         slope = matmul(law%enforcement%held(:d, :d), slope)
      end if
      state%normal = -frame(:, 3)%v
      state%gap = dot_product(state%normal(:d), apart)
      if (law%enforcement%partly) state%gap = dot_product(state%normal(:d), &
         & matmul(law%enforcement%held(:d, :d), apart))
      state%slip = 0.0_wp
      state%status = contact_status%stick
      state%weight = self%weight
      state%force = spread(0.0_wp, 1, local%nu)
      if (self%apart) then
         ! The arm between the sides turns with the frame: its moment falls on the frame's facet.
         state%force = self%weight*matmul(state%traction(:d), slope)
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

      !> Slopes of rows without an arm.
      subroutine take_shares(shares)
         real(wp), intent(out) :: shares(:, :)      !! (d, nu)
         integer :: k, j

         shares = 0.0_wp
         do j = 1, size(self%node)
            do k = 1, d
               if (input(k, j) > 0) shares(k, input(k, j)) = self%share(j)
            end do
         end do
      end subroutine take_shares

      !> And what the arm takes of them, by the tangents of its facet.
      subroutine take_arm(slope)
         real(wp), intent(inout) :: slope(:, :)     !! (d, nu)
         integer :: j, k, m

         allocate (along(d*(d - 1), local%nu), source=0.0_wp)
         do j = 1, size(self%node)
            do m = 1, d - 1
               do k = 1, d
                  if (input(k, j) > 0) along(k + (m - 1)*d, input(k, j)) = self%along(m, j)
               end do
            end do
         end do
         do k = 1, d
            slope(k, :) = slope(k, :) - matmul(arm(k)%d(:d*(d - 1)), along)
         end do
      end subroutine take_arm

      subroutine make_matrix()
         if (allocated(local%k)) deallocate (local%k)
         if (allocated(local%spring)) deallocate (local%spring)
         if (allocated(local%flat_row)) deallocate (local%flat_row)
         if (allocated(local%share)) deallocate (local%share)
         if (allocated(local%tangent)) deallocate (local%tangent)
         call find_own()
         if (.not. allocated(local%glue)) allocate (local%glue)
         local%glue = glue_type(weight=self%weight, c=c, turns=self%apart)
         if (law%enforcement%partly) local%glue%give(:d, :d) = (unity(:d, :d) &
            & - law%enforcement%held(:d, :d))/c
         local%reach = slope
         if (self%near) then
            allocate (local%share(d, local%nu))
            call take_shares(local%share)
            if (law%enforcement%partly) local%share = matmul(law%enforcement%held(:d, :d), &
               & local%share)
         end if
         if (self%apart) then
            ! The arm turns with the places of its frame's nodes.
            local%glue%turning(:d*(d - 1), :d*(d - 1)) = self%weight*turning_slopes(tangent, &
               & self%offset, state%traction)
            call move_alloc(along, local%tangent)
         end if
         local%stiff = self%weight*c*unity(:d, :d)
         local%firm = local%stiff
      end subroutine make_matrix

      !> Each row gives a displacement of the node, but along axes in which supports hold it; where
      !> these are not the global ones, none does.
      subroutine find_own()
         integer :: k

         local%own = 0
         local%own(:d) = input(:, self%slave)
         if (.not. law%enforcement%partly) return
         associate (held => law%enforcement%held(:d, :d))
            do k = 1, d
               if (any(abs(held(:, k) - held(k, k)*unity(:d, k)) > aligned)) local%own = 0
               if (held(k, k) < 0.5_wp) local%own(k) = 0
            end do
         end associate
      end subroutine find_own
   end subroutine evaluate_tie
end module lopin_tie_element
