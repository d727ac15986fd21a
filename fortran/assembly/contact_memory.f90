!> What the search of contacts on the present shape remembers between increments, to a stream and
!> back.
!>
!> Reading needs contacts that were made anew from the same model: surfaces, trees of boxes and what
!> the deck says of stiffnesses come from there, and positions from the next start of an increment.
module lopin_contact_memory
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_surface, only : update_surface
   use lopin_search, only : refit_tree
   use lopin_finite_contact, only : finite_contact_type
   use lopin_finite_masters, only : master_type
   use lopin_finite_opposite, only : anchor_type, opposite_type
   use lopin_finite_mortar, only : update_mortar, meet_row
   use lopin_finite_meeting, only : tie_to_facet
   implicit none
   private
   public :: keep_contact

contains

   !> What the search found when it met points first, and goes on from; histories are state.
   subroutine keep_contact(self, stream, error)
      type(finite_contact_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call stream%pass(self%loose)
      call stream%pass(self%yields)
      call stream%pass(self%tied_at)
      ! Shown where nothing is opposite any more.
      call stream%pass(self%normal)
      call stream%pass(self%xi)
      ! Counted with the next increment.
      call stream%pass(self%cost%query)
      call stream%pass(self%cost%box)
      call stream%pass(self%cost%projection)
      call stream%pass(self%masters%part)
      do i = 1, size(self%masters%of)
         call keep_master(self%masters%of(i), stream)
         call stream%pass(self%mortar(i)%cover%state)
      end do
      do i = 1, self%n
         call keep_anchor(self%anchor(i), stream)
         call keep_opposite(self%opposite(i), stream)
      end do
      if (stream%reading .and. .not. stream%broken .and. allocated(self%tied_at)) &
         & call tie_again(self, error)
   end subroutine keep_contact

   !> A surface that meets itself measured its walls before they were pressed together.
   subroutine keep_master(self, stream)
      type(master_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%against_itself)
      call stream%pass(self%first_point)
      call stream%pass(self%itself%first)
      call stream%pass(self%itself%neighbour)
      call stream%pass(self%itself%depth)
   end subroutine keep_master

   subroutine keep_anchor(self, stream)
      type(anchor_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%set)
      call stream%pass(self%nnode)
      call stream%pass_within(self%node)
      call stream%pass_within(self%share)
      call stream%pass_within(self%y)
      call stream%pass_within(self%offset)
      call stream%pass(self%gap)
   end subroutine keep_anchor

   !> What mortar leaves as it is where a point is no longer covered.
   subroutine keep_opposite(self, stream)
      type(opposite_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%facet)
      call stream%pass_within(self%normal)
      call stream%pass(self%found%gap)
      call stream%pass(self%foot%gap)
   end subroutine keep_opposite

   !> Ties by mortar keep the rows of the shape on which they were made: made again on it.
   subroutine tie_again(self, error)
      type(finite_contact_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: pair, i
      logical :: covered

      do i = 1, self%n
         if (self%grip(i)%tied .and. self%anchor(i)%set &
            & .and. .not. self%loose(i)) &
            & call tie_to_facet(self, i, self%tied_at)
      end do
      do pair = 1, size(self%mortar)
         if (.not. (self%mortar(pair)%is_on .and. self%mortar(pair)%tied)) cycle
         associate (m => self%masters%of(pair), mortar => self%mortar(pair), x => self%tied_at)
            call update_surface(m%surface, x, error)
            if (allocated(error)) return
            call refit_tree(m%tree, m%surface%low, m%surface%high)
            call update_mortar(mortar, self%masters%rules, m%surface, m%tree, x, .true., error)
            if (allocated(error)) return
            do i = 1, self%n
               if (self%pair(i) == pair) call meet_row(mortar, m%surface, self%masters%rules, x, &
                  & i, .true., self%patch(i), self%mortar_anchor(i), covered, &
                  & self%opposite(i)%normal, self%opposite(i)%found%gap)
            end do
         end associate
      end do
   end subroutine tie_again
end module lopin_contact_memory
