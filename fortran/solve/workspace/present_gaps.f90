!> Gaps and relative motions of points of the linear paths in the trial displacements.
module lopin_present_gaps
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_constraint_rules, only : follower_rule
   use lopin_contact_points, only : pair_is_tied
   use lopin_row_samples, only : sample_type, find_samples, has_samples, row_value
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: relative_motion, gap_of, row_gap_of

contains

   !> Gap of the row that a point has or would have, as linear in the displacements as rows are.
   pure real(wp) function row_gap_of(self, model, point) result(gap)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      type(sample_type), allocatable :: sample(:)
      real(wp) :: way(3)
      integer :: s, m, k

      if (.not. has_samples(self%points, point)) then
         gap = gap_of(self, model, point)
         return
      end if
      call find_samples(self%points, point, model%mesh%x, sample)
      gap = row_value(self%points, sample, self%initial%shift)
      do s = 1, size(sample)
         way = -tool_way(self, model, self%points%pair(point), sample(s)%foot, .true.)
         do k = 1, model%mesh%ndim
            do m = 1, sample(s)%nnode
               if (self%dofs%id(k, sample(s)%node(m)) > 0) way(k) = way(k) + sample(s)%shape(m) &
                  & *self%trial%motion%u(self%dofs%id(k, sample(s)%node(m)))
            end do
         end do
         gap = gap + sample(s)%c*(sample(s)%gap + dot_product(sample(s)%normal, way))
      end do
   end function row_gap_of

   !> Geometric gap of a point, as linear in the displacements as rows are.
   pure real(wp) function gap_of(self, model, point) result(gap)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: point

      gap = self%points%gap(point) + self%initial%shift(point) &
         & + dot_product(self%points%normal(:, point), &
         & relative_motion(self, model, point, since_projection=.true.))
   end function gap_of

   !> Displacement of a slave point relative to the master opposite, since the start or since the
   !> tool was projected where it stands now.
   pure function relative_motion(self, model, point, since_projection) result(motion)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      logical, intent(in) :: since_projection
      real(wp) :: motion(3)
      integer :: k, m, ndim

      ndim = model%mesh%ndim
      motion = 0.0_wp
      do k = 1, ndim
         if (self%dofs%id(k, self%points%node(point)) > 0) motion(k) = &
            & self%trial%motion%u(self%dofs%id(k, &
            & self%points%node(point)))
      end do
      do m = 1, size(self%points%master, 1)
         if (self%points%master(m, point) == 0) exit
         do k = 1, ndim
            if (self%dofs%id(k, self%points%master(m, point)) == 0) cycle
            motion(k) = motion(k) - self%points%shape(m, &
               & point)*self%trial%motion%u(self%dofs%id(k, &
               & self%points%master(m, point)))
         end do
      end do
      motion = motion - tool_way(self, model, self%points%pair(point), self%points%foot(:, point), &
         & since_projection)
   end function relative_motion

   !> Displacement of the point of a pair's tool at a foot, since the start or since it was
   !> projected where it stands now; 0 of what no node moves.
   pure function tool_way(self, model, pair, foot, since_projection) result(way)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: foot(3)          !! [length]
      logical, intent(in) :: since_projection
      real(wp) :: way(3), arm(3), coefficient(3), moved, place(6)
      integer :: k, ndim, body, dof(3), n, j

      way = 0.0_wp
      ndim = model%mesh%ndim
      body = self%points%body(pair)
      if (body == 0) return
      place = 0.0_wp
      if (.not. pair_is_tied(model, model%pair(pair))) place = self%place(:, body)
      arm = 0.0_wp
      associate (reference => model%rigid_body(body)%reference)
         arm(:ndim) = foot(:ndim) - model%mesh%x(:, reference) - place(:ndim)
         do k = 1, ndim
            call follower_rule(arm, ndim, k, dof, coefficient, n)
            do j = 1, n
               if (self%dofs%id(dof(j), reference) == 0) cycle
               moved = self%trial%motion%u(self%dofs%id(dof(j), reference))
               if (since_projection) moved = moved - place(dof(j))
               way(k) = way(k) + coefficient(j)*moved
            end do
         end do
      end associate
   end function tool_way
end module lopin_present_gaps
