!> Pairs of which neither side can deform: what presses is then not determined.
module lopin_check_rigid_pairs
   use lopin_model, only : model_type, surface_of
   use lopin_block, only : complain
   implicit none
   private
   public :: check_rigid_pairs

contains

   subroutine check_rigid_pairs(model)
      type(model_type), intent(inout) :: model
      logical :: follows(model%mesh%nnode)
      integer :: i

      follows = .false.
      do i = 1, size(model%rigid_body)
         if (allocated(model%rigid_body(i)%node)) follows(model%rigid_body(i)%node) = .true.
      end do
      if (.not. any(follows)) return
      do i = 1, size(model%pair)
         associate (pair => model%pair(i))
            if (.not. is_rigid(model, pair%slave, follows)) cycle
            if (.not. is_rigid(model, pair%master, follows)) cycle
            call complain(model%log, 'E0317', 'both sides of the pair '// &
               & model%surface(pair%slave)%name//', '//model%surface(pair%master)%name// &
               & ' are rigid', pair%at, note='nothing deforms: how the force is shared by the '// &
               & 'nodes is not determined', help='let one of the bodies be elastic')
         end associate
      end do
   end subroutine check_rigid_pairs

   !> A tool, or a surface whose nodes all follow rigid bodies.
   pure logical function is_rigid(model, surface, follows)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical, intent(in) :: follows(:)        !! (nnode)
      integer :: k, e, node

      associate (s => model%surface(surface))
         is_rigid = s%tool > 0
         if (is_rigid) return
         if (s%kind == surface_of%nodes) then
            is_rigid = all(follows(s%node))
            return
         end if
         if (.not. allocated(s%element)) return
         if (size(s%element) == 0) return
         do e = 1, size(s%element)
            do k = 1, size(model%mesh%conn, 1)
               node = model%mesh%conn(k, s%element(e))
               if (node == 0) exit
               if (.not. follows(node)) return
            end do
         end do
         is_rigid = .true.
      end associate
   end function is_rigid
end module lopin_check_rigid_pairs
